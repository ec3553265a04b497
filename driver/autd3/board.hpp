// AUTD3 devices behind a server that speaks the Remote protocol: `autd3:HOST:PORT`, one device per board of the layout.
//
// A device plays a pattern by its own clock. Of the plans that the loop tells, one at a time is brought over, a message
// per part (or per two, where all transducers are at full amplitude), each of which the devices acknowledge after about
// a millisecond; then comes the newest there is. One finger's foci at full amplitude are one message: devices compute
// their phases. It goes into the segment that does not sound, and sounds as a whole. Its parts are turned so that the
// slot that is running sounds. Drives that no plan lists come one by one, the newest as soon as the one before is
// acknowledged.
//
// The first drive of nothing that is not the pattern's own silences at once: amplitudes of zero. So does the start: a
// device that was left sounding is cleared before anything else.
#pragma once

#include "driver/board.hpp"

namespace palpa::driver::autd3 {

/// `autd3`.
BoardKind board_kind();

}  // namespace palpa::driver::autd3
