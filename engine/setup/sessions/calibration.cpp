#include "setup/sessions/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/synthetic.hpp"
#include "sensing/target.hpp"

namespace palpa::setup {
namespace {

constexpr double step_s = 0.1, patience_s = 5;

/// Everything is at rest, so it is drawn only once. There is no skin.
std::unique_ptr<sensing::DepthSource> open_rehearsal(const std::string& file, const session::SourceSetting& setting,
                                                     const std::optional<Transform>& T_world_target) {
  if (setting.cameras.empty())
    throw bad_input(setting.rig, "has no [[camera]]; a synthetic source renders what the rig's cameras see");
  geometry::Mesh things = T_world_target ? sensing::make_target() : geometry::Mesh();
  for (Vec3& p : things.positions)
    p = transform_point(*T_world_target, p);
  geometry::append(things, setting.occluders);
  if (!file.empty()) geometry::append(things, session::load_skin(file));
  sensing::SyntheticOptions options;
  options.motion = [](double) { return Transform(1.0); };
  options.noise = setting.noise ? sensing::Noise::d415 : sensing::Noise::none;
  options.seed = setting.seed;
  options.paced = setting.paced;
  if (!file.empty()) options.occluders_name = file;
  return sensing::make_synthetic_source(setting.cameras, {}, things, options);
}

double angle_of(const Transform& turn) {
  return std::acos(std::clamp((turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2, -1.0, 1.0));
}

}  // namespace

session::SourceKind rehearsal(const std::optional<Transform>& T_world_target) {
  return {"synthetic",
          T_world_target ? "synthetic[:MESH]: the target on its mount, and the mesh's objects in the world, at rest"
                         : "synthetic[:MESH]: the array's boards, and the mesh's objects in the world, at rest",
          [T_world_target](const std::string& file, const session::SourceSetting& setting) {
            return open_rehearsal(file, setting, T_world_target);
          }};
}

std::uint64_t take_frames(sensing::DepthSource& source, std::uint64_t frames,
                          const std::function<void(const sensing::FrameSet&)>& take) {
  sensing::FrameSet set;
  std::uint64_t taken = 0;
  double waited_s = 0;
  const std::atomic<bool>* const stop = cancel_flag();
  while (taken < frames && source.next(set, step_s)) {
    stop_if_cancelled(stop);
    if (set.frames.empty()) {
      waited_s += step_s;
      if (waited_s > patience_s) throw failure(fmt::format("--source: no frame came for {} s", patience_s));
      continue;
    }
    waited_s = 0;
    ++taken;
    take(set);
  }
  if (taken == 0) throw failure("--source: it ended before its first frame");
  return taken;
}

std::vector<sensing::StillFrames> collect_still_frames(sensing::DepthSource& source, std::uint64_t frames,
                                                       const std::function<void(std::uint64_t)>& done) {
  std::vector<sensing::StillFrames> seen;
  for (const sensing::Camera& camera : source.cameras())
    seen.emplace_back(camera);
  std::uint64_t taken = 0;
  take_frames(source, frames, [&](const sensing::FrameSet& set) {
    for (std::size_t i = 0; i < seen.size(); ++i)
      seen[i].add(set.frames[i].depth, set.sequence);
    done(++taken);
  });
  return seen;
}

void check_same_cameras(const std::vector<sensing::Camera>& rig, const std::vector<sensing::Camera>& source,
                        const std::string& rig_file) {
  if (rig.size() != source.size()) {
    throw bad_input(rig_file, fmt::format("has {} [[camera]], and the source has {}: it must list the same cameras in "
                                          "the same order",
                                          rig.size(), source.size()));
  }
  for (std::size_t i = 0; i < rig.size(); ++i) {
    if (rig[i].width != source[i].width || rig[i].height != source[i].height) {
      throw bad_input(rig_file, fmt::format("its [[camera]] {} has {}x{} pixels, and the source's has {}x{}", i + 1,
                                            rig[i].width, rig[i].height, source[i].width, source[i].height));
    }
  }
}

std::vector<CalibratedCamera> calibrate_cameras(const std::vector<sensing::Camera>& rig,
                                                const std::vector<sensing::Camera>& source,
                                                const std::vector<sensing::StillFrames>& seen,
                                                const Transform& T_world_target, const std::string& rig_file) {
  check_same_cameras(rig, source, rig_file);
  std::vector<CalibratedCamera> cameras;
  for (std::size_t i = 0; i < rig.size(); ++i) {
    CalibratedCamera camera;
    camera.name = rig[i].name;
    camera.found = sensing::find_target(source[i], seen[i].finish());
    camera.T_world_camera = T_world_target * glm::inverse(camera.found.T_camera_target);
    for (int column = 0; column < 4; ++column)
      camera.T_world_camera[column][3] = column == 3 ? 1 : 0;  // exact despite rounding
    const Transform between = glm::inverse(rig[i].T_world_camera) * camera.T_world_camera;
    camera.moved_m = glm::length(Vec3(between[3]));
    camera.turned_rad = angle_of(between);
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace palpa::setup
