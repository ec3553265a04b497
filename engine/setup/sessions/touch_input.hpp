// The skin of a touch: skin points from a file or from depth images. Also the options for it and for the scene.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "setup/options/options.hpp"

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
  std::map<std::string, sensing::Camera> made_cameras;  ///< those of `cameras` that are no files, by their names
  std::string rig;
  std::optional<double> penetration_m;
};
void add_touch_input(CLI::App& app, TouchInputOptions& options);
/// Throws bad_usage for options that are missing or exclude each other.
void check(const TouchInputOptions& options);

struct TouchInput {
  std::vector<sensing::SkinPoint> points;  ///< from --points
  std::vector<sensing::Camera> cameras;    ///< from --depth; then `frames` has one frame for each
  std::vector<sensing::DepthFrame> frames;
  std::uint64_t point_count = 0;  ///< total number of skin points; with depth images, of valid pixels
};

/// Skin points in metres, world; their indices are their positions in the list. Throws bad_input naming `file` for
/// coordinates outside the range of single precision.
TouchInput skin_points(const std::string& file, std::span<const Vec3> positions);

/// Warns, with this name in front, of skin that is probably in another unit than metres. False: too few points show
/// nothing.
bool warn_of_skin(const std::string& name, std::span<const Vec3> positions);

/// Warns of cameras that see nearly nothing because of their min_range_m.
void warn_of_min_range(const TouchInput& input);

/// Reads the files of the skin. --penetration shifts the skin relative to the top of `solids`. Throws bad_input naming
/// file and fault.
TouchInput load_touch_input(const TouchInputOptions& options, std::span<const geometry::Solid> solids);

/// The cameras of the depth images that the options name, one for each: from --camera, otherwise from the rig. Throws
/// as load_touch_input does.
std::vector<sensing::Camera> load_cameras(const TouchInputOptions& options);

/// The y of the highest point of the solids.
double top_of(std::span<const geometry::Solid> solids);
/// The shift along y for --penetration: afterwards, the lowest point lies that far below the highest point of the
/// solids. There must be at least one point.
double lowering(std::span<const geometry::Solid> solids, std::span<const Vec3> points, double penetration_m);

}  // namespace palpa::setup
