// `--source realsense:SERIAL[,SERIAL...]`: RealSense cameras through the librealsense2 SDK, as a DepthSource
// (driver/cameras). A camera that was unplugged is found again by its serial number.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/host.hpp"
#include "driver/realsense/sdk.hpp"
#include "sensing/depth_source.hpp"
#include "session/links/sources.hpp"

namespace palpa::driver::realsense {

/// Opens the cameras with these serial numbers, in the rig's order, or, for "any", the only one that is plugged in.
/// `rig` is the file that describes the cameras, for messages. Throws Error for what is refused: see Device.
std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<cameras::Host> host, const std::shared_ptr<Sdk>& sdk,
                                                   std::vector<sensing::Camera> cameras, const std::string& argument,
                                                   const std::string& rig);

/// For the command line, whether palpa is built with the SDK or not.
session::SourceKind source_kind();

}  // namespace palpa::driver::realsense
