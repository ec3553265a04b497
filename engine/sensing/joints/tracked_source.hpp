// A tracker's hands as a source of frames: bones in the world, from which a session makes skin points.
#pragma once

#include <memory>

#include "base/math.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/joints/tracker.hpp"

namespace palpa::sensing {

/// A source without cameras. Its frames have capsules.
std::unique_ptr<DepthSource> make_tracked_source(std::unique_ptr<Tracker> tracker, const Transform& T_world_joints);

}  // namespace palpa::sensing
