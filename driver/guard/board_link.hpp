// The link of a board: hands drives to a guard, which alone has the device open. The loop never waits for the device.
#pragma once

#include <string>
#include <vector>

#include "driver/board.hpp"
#include "session/links/link.hpp"

namespace palpa::driver {

/// The link kind of a board. Opening it starts `program` (guard_program() where empty) and waits until it has opened
/// the board; what the board refuses is thrown as it said it. What the board notes is logged, with the link's name
/// before it.
///
/// send() throws failure() once the guard is gone. If it was not asked to leave, another is started before, which does
/// nothing but silence the board; the line says whether it could. finish() waits up to 1 s for the guard's exit, and
/// throws failure() where nobody knows that the last silence has reached the board.
session::LinkKind board_link(const BoardKind& kind, const std::string& program = {});

/// Those of all boards.
std::vector<session::LinkKind> board_links();

}  // namespace palpa::driver
