// The SDK itself. Only in a palpa that is built with it.
#pragma once

#include <librealsense2/rs.h>

#include <memory>

#include "driver/realsense/sdk.hpp"

namespace palpa::driver::realsense {

/// Takes over a context into which a test has put software devices.
std::unique_ptr<Sdk> make_sdk(rs2_context* context);

}  // namespace palpa::driver::realsense
