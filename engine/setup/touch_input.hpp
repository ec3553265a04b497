// What touches: skin points from a file or from depth images. And the options that say so, with the scene's.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "setup/options.hpp"

namespace CLI {
class App;
}

namespace palpa::setup {

struct TouchInputOptions {
  std::string scene;
  std::optional<std::uint32_t> gltf_scene;
  SolidOptions solids;
  std::string points;
  std::vector<std::string> depths, cameras;
  std::string rig;
  std::optional<double> penetration_m;
};
void add_touch_input(CLI::App& app, TouchInputOptions& options);
/// Throws bad_usage for what is missing or excludes each other.
void check(const TouchInputOptions& options);

struct TouchInput {
  std::vector<sensing::SkinPoint> points;  ///< from --points
  std::vector<sensing::Camera> cameras;    ///< from --depth: then `frames` has one for each
  std::vector<sensing::DepthFrame> frames;
  std::uint64_t point_count = 0;  ///< skin points in all, of depth images the valid pixels
};

/// Skin points in metres, world; their indices are their places. Throws bad_input naming `file` for coordinates that
/// no single-precision number can hold.
TouchInput skin_points(const std::string& file, std::span<const Vec3> positions);

/// Reads the files of the skin, which --penetration shifts by how high `solids` are. Throws bad_input naming file and
/// fault.
TouchInput load_touch_input(const TouchInputOptions& options, std::span<const geometry::Solid> solids);

/// What --penetration adds to the points' y, so that the lowest of them, of which there is one at least, lies that far
/// below the highest point of the solids.
double lowering(std::span<const geometry::Solid> solids, std::span<const Vec3> points, double penetration_m);

}  // namespace palpa::setup
