// SonicSurface boards on a serial port: `sonicsurface:PORT[,tactile|,lag=PERIODS]`, one board or, if the layout has
// two, a primary and a secondary one. docs/boards.md says how the polarity of their transducers is given
// (--board-files).
//
// A frame takes 11.3 ms, so foci that run faster cannot be played. Foci that stand still and are modulated, a single
// focus or several at once, can be played: one buffer holds their pattern, the other silence, and one byte swaps the
// two. A pattern that has changed is sent at most 16 times a second, in a pause of the modulation.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "driver/board.hpp"
#include "driver/clock.hpp"

namespace palpa::driver::sonicsurface {

/// The shortest time between two transfers of a changed pattern, while the boards modulate.
inline constexpr double refresh_s = 60e-3;

/// The degrees of `sonicsurface.txt` in that folder, one number per transducer of all boards; "": none. Throws
/// bad_input.
std::vector<float> read_degrees(const std::string& folder, std::size_t count);

/// The kind of board that `--link sonicsurface:...` names.
BoardKind board_kind();

/// A board in the time of that clock, which must outlive it. Throws as BoardKind::open does.
std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, Clock& clock);

}  // namespace palpa::driver::sonicsurface
