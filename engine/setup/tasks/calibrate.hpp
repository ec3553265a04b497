// The computation of `palpa calibrate`, except for --nudge: the poses of a rig's cameras from their frames of the
// calibration target, the target itself, and the rig of an array that was nudged. The method is in
// setup/sessions/calibration.hpp. Metres, world frame.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/json_writer.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rig.hpp"
#include "session/links/sources.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/calibration.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::setup {

/// The place of the target, if it is not on its mount (target_mount.hpp).
struct TargetPlace {
  std::string at;       ///< "x,y,z", the middle of its underside in the layout's own frame; empty: on its mount
  double turn_deg = 0;  ///< of the target about its own z, counter-clockwise seen from above
};

/// Its pose in the world.
Transform pose_of_target(const TargetPlace& place, const PlacedLayout& placed);

/// Frames of things at rest.
struct StillTask {
  std::string source;        ///< as session::open_source takes it; empty: a rehearsal, the rig's own cameras rendered
  std::uint64_t frames = 0;  ///< number of frames combined; 0: as many as usual
  bool noise_free = false;   ///< synthetic frames without the sensor's noise
  std::uint64_t seed = 0;    ///< seed of that noise
  RigOptions rig;
};
/// Throws bad_usage for a real source with `noise_free`.
void check(const StillTask& task);
/// The source of these frames; `sources` are added to palpa's own. A rehearsal shows the target if it has a place.
std::unique_ptr<sensing::DepthSource> open_still_source(const StillTask& task, const PosedRig& posed,
                                                        std::span<const session::SourceKind> sources,
                                                        const std::optional<Transform>& T_world_target);

struct CalibrateTask : StillTask {  ///< at most 100 frames, usually 30
  TargetPlace target;
};
/// Throws bad_usage, naming the command's options, for too many frames and for a real source with `noise_free`.
void check(const CalibrateTask& task);

/// Callbacks during the calibration; each may be empty.
struct CalibrateWatch {
  /// all input is read and the source is open; number of frames to take
  std::function<void(std::uint64_t frames)> opened{};
  std::function<void(std::uint64_t frames)> taken{};  ///< after each frame: number of frames so far
  std::function<void()> all_taken{};                  ///< before the poses are computed
};

struct CalibrateResult {
  std::vector<CalibratedCamera> cameras;
  std::uint64_t frames = 0;  ///< number of frames taken
  Transform T_world_target{1.0};
  sensing::Rig rig;  ///< the rig with these poses, and with the array of RigOptions::layout if that is given
};
/// Adds a pose, by rows.
void add_pose(JsonWriter& json, const char* name, const Transform& T);
/// The output of `palpa calibrate --json` (docs/calibration.md).
std::string to_json(const CalibrateResult& result);

/// `sources` are added to palpa's own. Warns if the target or a camera has another scale, and if points lie far from
/// the target. Throws as check, load_posed_rig, session::open_source, collect_still_frames and calibrate_cameras do.
CalibrateResult calibrate(const CalibrateTask& task, std::span<const session::SourceKind> sources,
                          const CalibrateWatch& watch = {});

/// The target for that layout, in the position for printing, with its underside at z = 0.
geometry::Mesh target_to_print(const array::Layout& layout);
/// The same, in its place in the world.
geometry::Mesh target_in_world(const TargetPlace& place, const PlacedLayout& placed);

/// Throws bad_usage, naming the command's options, if the target cannot be written as that file: it ends in .stl for a
/// printer, where the target has no place, or in .glb.
void check_target_file(const std::string& file, const TargetPlace& place);
/// Writes the target as check_target_file() allows: as it is printed, in millimetres, or in its place in the world.
void write_target(const std::string& file, const TargetPlace& place, const PlacedLayout& placed);

/// The rig. If RigOptions::layout is given, it has that array instead of its own.
sensing::Rig rig_to_write(const PosedRig& posed, const RigOptions& options);
/// The limit of a nudge along each axis, metres.
inline constexpr double farthest_nudge_m = 0.05;
/// The same, for sound that is in the right place if `offset` (metres, world) is added to every focus, as
/// session::Session::set_aim() does: its array is moved by this offset in the opposite direction. Throws bad_usage,
/// naming `name`, if a coordinate of the offset exceeds the limit.
sensing::Rig nudged_rig(const PosedRig& posed, const RigOptions& options, const std::string& name, const Vec3& offset);
/// Writes the rig as a TOML file, for --rig.
void write_rig(const std::string& file, const sensing::Rig& rig);

}  // namespace palpa::setup
