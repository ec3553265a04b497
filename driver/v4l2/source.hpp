// `--source v4l2:/dev/videoN[,/dev/videoM...]`: depth cameras through the kernel's own driver, as a DepthSource
// (driver/cameras). A camera that was unplugged is found again by its serial number, whatever number its node then has.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "driver/v4l2/kernel.hpp"
#include "sensing/depth_source.hpp"
#include "session/links/sources.hpp"

namespace palpa::driver::v4l2 {

/// The nodes of "/dev/video0,/dev/video2". Throws bad_usage for no node, an empty one, and one that is named twice in
/// the same words; open_cameras() finds other repetitions.
std::vector<std::string> parse_nodes(const std::string& argument);

/// Opens one node per camera, in this order, and starts them. `rig` is the file that describes the cameras, for
/// messages. Throws Error for what is refused: see Stream. `kernel` belongs to the source.
std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<Kernel> kernel, std::vector<sensing::Camera> cameras,
                                                   const std::vector<std::string>& nodes, const std::string& rig);

/// For the command line.
session::SourceKind source_kind();

}  // namespace palpa::driver::v4l2
