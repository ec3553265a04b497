// The poses of a rig's cameras, from what they see of the calibration target (sensing/target.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sensing/depth_source.hpp"
#include "sensing/find_target.hpp"
#include "sensing/still_image.hpp"
#include "session/links/sources.hpp"

namespace palpa::setup {

/// Of each camera what stands still before it, from so many frames or as many as the source has; `done` is told after
/// each how many there are. Throws failure where the source ends before the first frame, or none comes for 5 s.
std::vector<sensing::StillFrames> collect_still_frames(sensing::DepthSource& source, std::uint64_t frames,
                                                       const std::function<void(std::uint64_t)>& done);

struct CalibratedCamera {
  std::string name;
  sensing::FoundTarget found;
  Transform T_world_camera{1.0};
  double moved_m = 0, turned_rad = 0;  ///< from where the rig had it
};

/// The poses of `rig`'s cameras, which `seen` are the frames of, as `source` describes them: it may know a lens better
/// than the rig. Nothing but the target says where a camera is: poses of either are no guess. Throws bad_input where
/// the numbers or sizes of cameras differ, and as sensing::find_target does.
std::vector<CalibratedCamera> calibrate_cameras(const std::vector<sensing::Camera>& rig,
                                                const std::vector<sensing::Camera>& source,
                                                const std::vector<sensing::StillFrames>& seen,
                                                const Transform& T_world_target, const std::string& rig_file);

/// The kind "synthetic[:MESH]" of calibration: the target on its mount, the boards, and the mesh's things, all at rest
/// in the world, as the rig's cameras see them.
session::SourceKind rehearsal(const Transform& T_world_target);

}  // namespace palpa::setup
