// AUTD3 devices behind a server that speaks the Remote protocol: `autd3:HOST:PORT`, one device per board of the layout.
//
// A device plays a pattern by its own clock. The loop's plans are transferred one at a time. When one is complete, the
// newest plan follows. A plan is a sequence of parts, one for each drive. It takes a message per part, or per two parts
// if all transducers are at full amplitude. The devices acknowledge each message after about a millisecond. The foci of
// one finger at full amplitude are one message, because devices compute their phases. A plan goes into the segment that
// does not sound, and sounds as a whole. Its parts are shifted so that it continues with the running slot. Drives that
// no plan lists are sent one by one, the newest as soon as the one before is acknowledged.
//
// The first all-zero drive that is not part of the pattern silences at once, with amplitudes of zero. The start also
// silences: a device that was left sounding is cleared before anything else.
#pragma once

#include <memory>

#include "driver/board.hpp"
#include "driver/clock.hpp"

namespace palpa::driver::autd3 {

struct Address;

/// `autd3`.
BoardKind board_kind();

/// A board on the server at this address, in the time of that clock. Throws as BoardKind::open does. The clock must
/// outlive it.
std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, const Address& address, Clock& clock);

}  // namespace palpa::driver::autd3
