// `--source bag:FILE`: the depth stream that RealSense Viewer, or anything else on librealsense, recorded: into a
// database of ROS 2 (.db3), or, before librealsense 2.58.1, into a bag of ROS (.bag). Both are called bags here.
//
// Size, lens, depth unit and rate come from the bag. The bag does not say where the camera stood: that comes from the
// rig, if the rig has one camera.
#pragma once

#include <memory>
#include <string>

#include "sensing/depth_source.hpp"
#include "session/links/sources.hpp"

namespace palpa::driver::rosbag {

/// `posed` gives name, pose, nearest range, and, if its size is the bag's, roi and mask; null: the camera stands at the
/// world's origin. `paced`: frames come at the intervals at which they were recorded, and late ones are dropped.
///
/// Throws bad_input as Bag and open_database() do, and for a bag without a depth stream or without its camera_info. A
/// bag that was cut short ends where it was cut, with a warning. If its clock steps back, stands still, or steps
/// forward by more than an hour, every image is played all the same, with a warning: times then go on at the camera's
/// rate.
std::unique_ptr<sensing::DepthSource> open_bag(const std::string& file, const sensing::Camera* posed, bool paced);

/// For the command line.
session::SourceKind source_kind();

}  // namespace palpa::driver::rosbag
