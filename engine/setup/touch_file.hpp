// What `palpa touch --json` wrote, read back as what it plays. The format is in docs/files.md.
#pragma once

#include <filesystem>

#include "array/schedule.hpp"

namespace palpa::setup {

struct PlayedTouch {
  array::Schedule schedule;
  bool together = false;  ///< fingers' foci sound together: the method was multi-focus
};

/// One voice per finger, in the file's order, which is its id: foci in the world (an empty sector has its neighbour's,
/// as it plays), the finger's own order and dwell or the common ones, its gain and the pressure that it asks for. A
/// finger whose foci stand still has no modulation here: it is as loud as at its crest. A slot is as long as the
/// shortest dwell. Throws bad_input: no touch, a focus, an order or a dwell that cannot be, no finger, more fingers
/// than a touch has.
PlayedTouch load_touch(const std::filesystem::path& file);

}  // namespace palpa::setup
