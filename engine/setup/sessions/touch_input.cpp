#include "setup/sessions/touch_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/plausible.hpp"
#include "line/values.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rays.hpp"
#include "sensing/rig.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::setup {

double top_of(std::span<const geometry::Solid> solids) {
  Box all;
  for (const geometry::Solid& solid : solids)
    all.add(solid.bounds.high);
  return all.high.y;
}

double lowering(std::span<const geometry::Solid> solids, std::span<const Vec3> points, double penetration) {
  double lowest = points.front().y;
  for (const Vec3& point : points)
    lowest = std::min(lowest, point.y);
  return top_of(solids) - penetration - lowest;
}

bool warn_of_skin(const std::string& name, std::span<const Vec3> positions) {
  // Fewer points need not show how large something is.
  constexpr std::size_t points_of_a_scan = 100;
  if (positions.size() < points_of_a_scan) return false;
  Box box;
  for (const Vec3& position : positions)
    box.add(position);
  if (const std::string odd = geometry::implausible_size(box); !odd.empty())
    log::warning(fmt::format("{} {}", name, odd));
  return true;
}

void warn_of_min_range(const TouchInput& input) {
  constexpr double nearly_all = 0.99;
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    const sensing::Camera& camera = input.cameras[i];
    if (!(camera.min_range_m > 0) || !sensing::implausible_range(camera.min_range_m).empty()) continue;
    const std::uint32_t first = sensing::first_valid_depth(camera);
    std::uint64_t depths = 0, near = 0, farthest = 0;
    for (const std::uint16_t depth : input.frames[i].depth) {
      depths += depth != 0 ? 1 : 0;
      near += depth != 0 && depth < first ? 1 : 0;
      farthest = std::max<std::uint64_t>(farthest, depth);
    }
    if (depths == 0 || static_cast<double>(near) < nearly_all * static_cast<double>(depths)) continue;
    log::warning(fmt::format(
        "camera \"{}\": its min_range_m = {:g} makes {} of the {} in its image no data: they reach to {:.3g} m",
        printable(camera.name, 60), camera.min_range_m, near == depths ? "all" : fmt::to_string(near),
        counted(depths, "depth"), static_cast<double>(farthest) * camera.depth_unit_m));
  }
}

namespace {

TouchInput load_points(const TouchInputOptions& options, std::span<const geometry::Solid> solids) {
  std::vector<Vec3> positions = geometry::read_ply(options.points).positions;
  warn_of_skin(options.points + ": its skin", positions);
  if (options.penetration_m && !positions.empty()) {
    const double dy = lowering(solids, positions, *options.penetration_m);
    for (Vec3& position : positions)
      position.y += dy;
  }
  return skin_points(options.points, positions);
}

}  // namespace

TouchInput skin_points(const std::string& file, std::span<const Vec3> positions) {
  TouchInput input;
  input.points.reserve(positions.size());
  for (const Vec3& p : positions) {
    const glm::vec3 single(p);
    if (!std::isfinite(single.x) || !std::isfinite(single.y) || !std::isfinite(single.z)) {
      throw bad_input(file, fmt::format("vertex {} lies beyond 3e38 m; coordinates are metres", input.points.size()));
    }
    input.points.push_back({single, static_cast<std::uint32_t>(input.points.size())});
  }
  input.point_count = input.points.size();
  return input;
}

namespace {

std::vector<sensing::Camera> load_rig_cameras(const TouchInputOptions& options) {
  const std::string rig = options.rig.empty() ? find_asset("rigs/paper.toml") : options.rig;
  std::vector<sensing::Camera> cameras = sensing::load_rig(rig).cameras;
  if (cameras.empty()) throw bad_input(rig, "has no [[camera]]; depth images need one each");
  if (cameras.size() != options.depths.size()) {
    throw bad_usage(fmt::format(
        "--depth: given {} times, but the rig {} has {} cameras: give one image per camera in the rig's order, or "
        "one --camera per image",
        options.depths.size(), rig, cameras.size()));
  }
  return cameras;
}

sensing::Camera load_camera(const std::string& file) {
  const sensing::Rig one = sensing::load_rig(file);
  if (one.cameras.size() != 1) {
    throw bad_input(file,
                    fmt::format("has {} cameras, but --camera takes one; --rig takes several", one.cameras.size()));
  }
  return one.cameras.front();
}

}  // namespace

std::vector<sensing::Camera> load_cameras(const TouchInputOptions& options) {
  if (options.cameras.empty()) return load_rig_cameras(options);
  std::vector<sensing::Camera> cameras;
  for (const std::string& file : options.cameras) {
    const auto made = options.made_cameras.find(file);
    cameras.push_back(made == options.made_cameras.end() ? load_camera(file) : made->second);
    if (const std::uint64_t pixels = sensing::padded_pixels(cameras); pixels > sensing::most_pixels) {
      throw bad_input(file, fmt::format("brings the cameras to {} pixels together; palpa takes at most {}", pixels,
                                        sensing::most_pixels));
    }
  }
  return cameras;
}

namespace {

TouchInput load_depths(const TouchInputOptions& options) {
  TouchInput input;
  input.cameras = load_cameras(options);
  for (std::size_t i = 0; i < options.depths.size(); ++i) {
    const sensing::Camera& camera = input.cameras[i];
    sensing::DepthFrame frame;
    sensing::read_png16(options.depths[i], camera.width, camera.height, frame.depth);
    input.frames.push_back(std::move(frame));
  }
  input.point_count = sensing::count_valid(input.cameras, input.frames);
  warn_of_min_range(input);
  return input;
}

}  // namespace

void add_touch_input(CLI::App& app, TouchInputOptions& options) {
  const line::Group group(app, "What touches what");
  add_scene(group, options.scene, options.gltf_scene);
  group.text("--points", options.points, "FILE", "PLY file with points of the skin, in metres, world coordinates");
  group.texts("--depth", options.depths, "FILE",
              "16-bit depth image (PNG), instead of --points; give it again for more cameras");
  group.texts("--camera", options.cameras, "FILE", "TOML file of the camera of each --depth, in the same order");
  group.text("--rig", options.rig, "FILE", "TOML file of all cameras, instead of --camera [the paper's rig]");
  group.quantity("--penetration", options.penetration_m, Quantity::length, {-10, 10},
                 "moves --points along y, so that the lowest is this far below the solids' top [no move]");
  add_solid_options(app, options.solids);
}

void check(const TouchInputOptions& o) {
  if (o.scene.empty()) throw bad_usage("--scene is missing: give a glTF model, such as assets/cube.glb");
  if (o.points.empty() == o.depths.empty()) {
    throw bad_usage(o.points.empty()
                        ? "no skin: give --points FILE.ply, or --depth FILE.png with its --camera FILE.toml"
                        : "--points and --depth exclude each other: give one of them");
  }
  if (!o.points.empty() && !(o.cameras.empty() && o.rig.empty()))
    throw bad_usage("--camera and --rig go with --depth, not with --points");
  if (o.depths.empty()) return;
  if (o.penetration_m) throw bad_usage("--penetration moves --points; depth images stay where their cameras are");
  if (!o.rig.empty() && !o.cameras.empty()) throw bad_usage("--rig and --camera exclude each other: give one of them");
  if (!o.cameras.empty() && o.cameras.size() != o.depths.size()) {
    throw bad_usage(fmt::format("--camera: given {} for {}; give one per image", counted(o.cameras.size(), "time"),
                                counted(o.depths.size(), "depth image")));
  }
}

TouchInput load_touch_input(const TouchInputOptions& options, std::span<const geometry::Solid> solids) {
  return options.depths.empty() ? load_points(options, solids) : load_depths(options);
}

}  // namespace palpa::setup
