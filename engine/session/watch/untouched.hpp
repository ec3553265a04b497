// Why nothing touched in a run or a replay.
#pragma once

#include <string>

#include "base/files/json_writer.hpp"

namespace palpa::session {

/// The skin that came nearest to a solid, among some of the frames.
struct UntouchedStats {
  std::string solid;      ///< empty: no skin was near the solids
  double distance_m = 0;  ///< to its surface
  bool inside = false;    ///< below it, so deeper than its shell
  std::string why;        ///< in words: "the nearest skin was 31.0 mm away from the surface of cube"
};

/// The key "untouched" (docs/run.md).
void write_untouched(const UntouchedStats& untouched, JsonWriter& json);

}  // namespace palpa::session
