// Where the driver's depth frames come from: real cameras, and recordings that other programs made of them.
#pragma once

#include <vector>

#include "session/links/sources.hpp"

namespace palpa::driver {

/// For the command line: `--source v4l2:...`, `realsense:...` and `bag:FILE`.
std::vector<session::SourceKind> camera_sources();

}  // namespace palpa::driver
