// What `palpa calibrate` computes, but for --nudge: the poses of a rig's cameras from what they see of the calibration
// target, and the target itself. What is solved stands in setup/calibration.hpp. Metres, world frame.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "sensing/rig.hpp"
#include "session/links/sources.hpp"
#include "setup/calibration.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"

namespace palpa::setup {

/// Where the target stands, if not on its mount (target_mount.hpp).
struct TargetPlace {
  std::string at;       ///< "x,y,z", the middle of its underside in the layout's own frame; empty: on its mount
  double turn_deg = 0;  ///< of the target about its own z, from above counter-clockwise
};

struct CalibrateTask {
  std::string source;        ///< as session::open_source takes it; empty: a rehearsal, the rig's own cameras rendered
  std::uint64_t frames = 0;  ///< taken together, at most 100; 0: 30
  bool noise_free = false;   ///< synthetic frames without the sensor's noise
  std::uint64_t seed = 0;    ///< of that noise
  RigOptions rig;
  TargetPlace target;
};
/// Throws bad_usage, which names the command's options, for too many frames and for a real source without noise.
void check(const CalibrateTask& task);

/// What is said while cameras are looked at; each may be empty.
struct CalibrateWatch {
  std::function<void(std::uint64_t frames)> opened{};  ///< all is read and the source is open; so many are to be taken
  std::function<void(std::uint64_t frames)> taken{};   ///< after each frame: how many there are
  std::function<void()> all_taken{};                   ///< before poses are computed
};

struct CalibrateResult {
  std::vector<CalibratedCamera> cameras;
  std::uint64_t frames = 0;  ///< that were taken
  Transform T_world_target{1.0};
  sensing::Rig rig;  ///< the rig with these poses, and with the array of RigOptions::layout where that is given
};
/// What `palpa calibrate --json` writes (docs/files.md).
std::string to_json(const CalibrateResult& result);

/// `sources` come beside palpa's own. Warns of a target or a camera of another scale, and of points that lie far from
/// the target. Throws as check, load_posed_rig, session::open_source, collect_still_frames and calibrate_cameras do.
CalibrateResult calibrate(const CalibrateTask& task, std::span<const session::SourceKind> sources,
                          const CalibrateWatch& watch = {});

/// The target for that layout as it is printed, its underside at z = 0.
geometry::Mesh target_to_print(const array::Layout& layout);
/// The same in the world, where it stands.
geometry::Mesh target_in_world(const TargetPlace& place, const PlacedLayout& placed);

/// The rig with the array of RigOptions::layout in place of its own, where that is given.
sensing::Rig rig_to_write(const PosedRig& posed, const RigOptions& options);

}  // namespace palpa::setup
