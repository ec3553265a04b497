// The links that the driver adds to the engine's own.
#pragma once

#include <vector>

#include "session/links/link.hpp"

namespace palpa::driver {

/// For the command line, the viewer and Python: those of all boards (driver/boards.cpp). A link without a board goes
/// here, too.
std::vector<session::LinkKind> links();

}  // namespace palpa::driver
