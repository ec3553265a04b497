// SonicSurface boards on a serial port: `sonicsurface:PORT[,tactile]`, one or, where the layout has two, a primary and
// a secondary one. docs/boards.md says how their transducers' polarity is told (--board-files).
//
// A frame takes 11.3 ms, so foci that run faster cannot be played. What stands still and is modulated, a single focus
// or several at once, can: its pattern lies in one buffer, nothing in the other, and one byte lets them change places.
// A pattern that has changed comes over 16 times a second at most, in a pause of the modulation.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "driver/board.hpp"

namespace palpa::driver::sonicsurface {

/// A pattern that has changed is brought over that often at most, while the boards modulate.
inline constexpr double refresh_s = 60e-3;

/// The degrees of `sonicsurface.txt` in that folder, one number per transducer of all boards; "": none. Throws
/// bad_input.
std::vector<float> read_degrees(const std::string& folder, std::size_t count);

/// `sonicsurface`.
BoardKind board_kind();

}  // namespace palpa::driver::sonicsurface
