// The depth cameras that are plugged in, as a rig describes cameras.
#pragma once

#include "cli/doctor.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

/// Every node that gives depth, in the order of their numbers: the size and rate that palpa is made for, or what comes
/// nearest, and the lens as the camera keeps it. Opens each for a moment and starts no stream.
cli::CamerasThere cameras_there(Kernel& kernel);

}  // namespace palpa::driver::v4l2
