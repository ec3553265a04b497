// The fixed list of ideal observers. The first is the design, the others show how much its choices matter.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "observer/responses.hpp"

namespace palpa::observer {

enum class Cue {
  spikes,          ///< counts of afferents
  spikes_at_once,  ///< the same if no wave took time
  class_sums,      ///< the counts of all afferents of a class
  stress,          ///< mean stress at 0.3 mm
  flutter,         ///< vibration in the band of RA
  vibration,       ///< vibration in the band of PC
};
enum class Scale {
  root,  ///< the square root
  plain,
  logarithm,  ///< of the value, at least a thousandth of the largest
  pattern,    ///< each map divided by its own root mean square
  total,      ///< the sum over all sites only
};
enum class Classes { all, ra, pc };
enum class Depth {
  passed,    ///< all depths are passed, and the observer knows each
  averaged,  ///< only the sum over all depths is felt
  offset,    ///< the finger is higher or lower than the observer thinks, by 3 mm (standard deviation)
};
enum class Placement { unknown, known };

struct Variant {
  const char* name;
  const char* what;  ///< a sentence for readers
  Cue cue = Cue::spikes;
  Scale scale = Scale::root;
  Classes classes = Classes::all;
  Depth depth = Depth::passed;
  Placement placement = Placement::unknown;
  bool linear = false;  ///< at the linear level instead of the reference
};

std::span<const Variant> observer_variants();

}  // namespace palpa::observer
