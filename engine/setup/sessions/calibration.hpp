// Finds the poses of a rig's cameras from their frames of the calibration target (sensing/target.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sensing/depth_source.hpp"
#include "sensing/find_target.hpp"
#include "sensing/still_image.hpp"
#include "session/links/sources.hpp"

namespace palpa::setup {

/// Calls `take` with frames from the source until there were `frames` of them or the source ends; returns their number.
/// Throws failure if the source ends before the first frame, or if no frame comes for 5 s.
std::uint64_t take_frames(sensing::DepthSource& source, std::uint64_t frames,
                          const std::function<void(const sensing::FrameSet&)>& take);

/// Throws bad_input if the numbers or sizes of the cameras differ.
void check_same_cameras(const std::vector<sensing::Camera>& rig, const std::vector<sensing::Camera>& source,
                        const std::string& rig_file);

/// For each camera, collects the still parts of its view from `frames` frames, or from as many as the source has.
/// `done` is called after each frame with the number so far. Throws failure if the source ends before the first frame,
/// or if no frame comes for 5 s.
std::vector<sensing::StillFrames> collect_still_frames(sensing::DepthSource& source, std::uint64_t frames,
                                                       const std::function<void(std::uint64_t)>& done);

struct CalibratedCamera {
  std::string name;
  sensing::FoundTarget found;
  Transform T_world_camera{1.0};
  double moved_m = 0, turned_rad = 0;  ///< relative to the rig's previous pose
};

/// The poses of `rig`'s cameras. `seen` are their frames. `source` is the source's description of the cameras, which
/// may have better lens data than the rig. Poses are found from the target only; existing poses in `rig` or `source`
/// are not used as a guess. Throws bad_input if the numbers or sizes of cameras differ, and as sensing::find_target
/// does.
std::vector<CalibratedCamera> calibrate_cameras(const std::vector<sensing::Camera>& rig,
                                                const std::vector<sensing::Camera>& source,
                                                const std::vector<sensing::StillFrames>& seen,
                                                const Transform& T_world_target, const std::string& rig_file);

/// The source kind "synthetic[:MESH]" for calibration: the rig's cameras see the target on its mount, if it is there,
/// the boards, and the objects of the mesh, all at rest in the world.
session::SourceKind rehearsal(const std::optional<Transform>& T_world_target);

}  // namespace palpa::setup
