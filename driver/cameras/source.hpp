// Several depth cameras as one DepthSource.
//
// Frames of several cameras are taken together by their capture times (match.hpp). A camera that is unplugged, stops or
// breaks is reported once and looked for again, under any number. Meanwhile its images have no data and the other
// cameras go on. Without any camera, no set comes, and the loop is silent after its hold.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/device.hpp"
#include "driver/cameras/host.hpp"
#include "sensing/depth_source.hpp"

namespace palpa::driver::cameras {

/// The names of "one,two". `kind` is the source's name and `example` one camera's, for messages. Throws bad_usage for
/// no name, an empty name, and a name that is given twice in the same words.
std::vector<std::string> parse_names(const std::string& argument, const std::string& kind, const std::string& example);

/// Throws bad_usage if the command line of the source `kind` names more or fewer cameras than the rig has, or more than
/// palpa takes.
void check_count(std::size_t named, std::size_t cameras, const std::string& kind, const std::string& rig);

/// Opens one device per camera, in this order, and starts them. `rig` is the file that describes the cameras, for
/// messages. Throws Error for what is refused: see Device::open(). The source owns `host`, which outlives the devices.
///
/// Once each of its caller's sets has been used, next() allocates nothing while no camera is gone. It waits no longer
/// than `timeout_s`: a camera that is gone is looked for and opened again in the background. The source's destructor
/// waits for that.
std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<Host> host, std::vector<sensing::Camera> cameras,
                                                   std::vector<std::unique_ptr<Device>> devices,
                                                   const std::string& rig);

}  // namespace palpa::driver::cameras
