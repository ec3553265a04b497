// How the boards of an array play foci, as far as the command line leaves that open.
#pragma once

#include <string>

#include "array/layouts/layout.hpp"
#include "setup/options/options.hpp"

namespace palpa::setup {

/// For boards that take `least_s` for each focus that moves, longer than the dwell: if the command line names no
/// method, sets single-focus and warns; a method of the caller's must then place one focus. `boards` begins the line.
/// Their gains do not change from slot to slot either.
void take_method_of_boards(TouchOptions& touch, double least_s, const std::string& boards, bool own_method);

/// Foci that stand still sound in the slots that suit the boards (array::still_slot_s), unless the command line gives a
/// dwell.
void take_dwell_of_boards(TouchOptions& touch, const array::Layout& layout, Steps steps);

/// Both, for a touch that is played on no link, but as if on the layout's own boards. Throws bad_usage for foci that
/// they cannot move so fast.
void take_play_of_boards(TouchOptions& touch, const array::Layout& layout, Steps steps, bool own_method);

}  // namespace palpa::setup
