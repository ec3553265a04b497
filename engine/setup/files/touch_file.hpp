// Reads the output of `palpa touch --json` back as a schedule. The format is in docs/touch.md.
#pragma once

#include <filesystem>
#include <string>

#include "array/schedule.hpp"

namespace palpa::setup {

struct PlayedTouch {
  array::Schedule schedule;
  bool together = false;  ///< the foci of a finger sound together; the method was multi-focus
};

/// One voice per finger; its id is the position in the file. A voice has foci in the world (an empty sector has its
/// neighbour's focus, as it is played), the finger's own order and dwell or the common ones, its gain and its requested
/// pressure. A finger with foci that stand still has no modulation here; it is as loud as at its crest. A slot is as
/// long as the shortest dwell. Throws bad_input if the file is not a touch, for an invalid focus, order or dwell, for
/// no finger, and for more fingers than a touch can have.
PlayedTouch load_touch(const std::filesystem::path& file);
/// The same from the content of such a file, which messages call `name`.
PlayedTouch read_touch(const std::string& name, const std::string& text);

}  // namespace palpa::setup
