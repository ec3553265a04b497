// The link of a board. It passes drives to a guard, which alone has the device open. The loop never waits for the
// device.
#pragma once

#include <string>

#include "driver/board.hpp"
#include "session/links/link.hpp"

namespace palpa::driver {

/// The link kind of a board. Opening it starts `program` (guard_program() if empty) and waits until that has opened the
/// board. If the board refuses, its Error is thrown unchanged. The board's notes are logged, with the link's name
/// before them.
///
/// send() throws failure() once the guard is gone. If that guard was not asked to leave, another one is started first,
/// which only silences the board; the line says whether it could. finish() waits up to 1 s for the guard's exit, and
/// throws failure() if it is not known whether the last silence has reached the board.
session::LinkKind board_link(const BoardKind& kind, const std::string& program = {});

}  // namespace palpa::driver
