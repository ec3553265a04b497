// AUTD3 units of the UDP line (makers' releases 0.10 to 0.13): `autd3-udp:NIC`, or `autd3-udp:[ADDRESS%SCOPE]:PORT` for
// emulated ones. One unit per board of the layout, in the order of their chain.
//
// Drives are sent one by one. Each goes into the bank that does not sound, and sounds on all units at the same moment,
// a short lead after its slot begins (protocol 2: as soon as each unit has it).
//
// A unit sounds on when nothing comes any more, for half a second at most: palpa has set that time in each unit before
// the first pattern. The first all-zero drive silences at once.
#pragma once

#include <memory>

#include "driver/autd3_udp/cable.hpp"
#include "driver/board.hpp"
#include "driver/clock.hpp"

namespace palpa::driver::autd3_udp {

/// `autd3-udp`.
BoardKind board_kind();

/// A board of the units on that cable, in the time of that clock. Throws as BoardKind::open does. The clock must
/// outlive it.
std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, std::unique_ptr<Cable> cable, Clock& clock);

}  // namespace palpa::driver::autd3_udp
