// A line of JSON as a frame of tracked hands: palpa's own form, or that of a Leap controller (docs/trackers.md).
#pragma once

#include <optional>
#include <string>

#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

/// nullopt for a line of a Leap's service that has no frame, such as its first, which states its version. Throws
/// bad_input, naming `name` and the fault: no JSON, another form, a number that is missing or not finite, a time beyond
/// 1e12 s, another number of joints or radii than 26, or another version of Leap's protocol than 6. Whether a hand is
/// plausible is not examined (hand_check.hpp).
std::optional<TrackedFrame> read_frame(const std::string& line, const std::string& name);

}  // namespace palpa::sensing
