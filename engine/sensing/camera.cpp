#include "sensing/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sensing/lens.hpp"

namespace palpa::sensing {

Vec2 project(const Camera& camera, const Vec3& point_camera) {
  const Vec2 n = Lens(camera.distortion, false).apply(Vec2(point_camera) / point_camera.z);
  return {camera.fx * n.x + camera.cx, camera.fy * n.y + camera.cy};
}

std::string implausible_unit(double depth_unit_m) {
  constexpr double coarsest = 0.01, finest = 1e-6;
  if (depth_unit_m >= finest && depth_unit_m <= coarsest) return {};
  return fmt::format(
      "depth_unit_m = {:g} means depths in steps of {:g} m, up to {:.3g} m; depth images in millimetres "
      "have depth_unit_m = 0.001",
      depth_unit_m, depth_unit_m, depth_unit_m * std::numeric_limits<std::uint16_t>::max());
}

std::string implausible_range(double min_range_m) {
  constexpr double largest = 5;
  if (min_range_m <= largest) return {};
  return fmt::format("min_range_m = {:g} makes all depths below {:g} m no data; if it is in millimetres, write {:g}",
                     min_range_m, min_range_m, min_range_m / 1000);
}

std::optional<Vec2> find_blind_pixel(const Camera& camera) {
  constexpr int steps = 32;
  const Lens lens(camera.distortion, true);
  for (int row = 0; row <= steps; ++row) {
    for (int column = 0; column <= steps; ++column) {
      const Vec2 pixel{(camera.width - 1.0) * column / steps, (camera.height - 1.0) * row / steps};
      const Vec2 target{(pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy};
      if (!lens.undo(target, target)) return pixel;
    }
  }
  return std::nullopt;
}

std::uint32_t first_valid_depth(const Camera& camera) {
  // The slack keeps a range that is a whole number of units from being lost to the rounding of the division.
  const double steps = std::ceil(camera.min_range_m / camera.depth_unit_m - 1e-6);
  return static_cast<std::uint32_t>(std::clamp(steps, 1.0, 65536.0));
}

std::uint16_t nearer_than_background(const Camera& camera, std::size_t pixel) {
  if (!camera.background || camera.background->depth[pixel] == 0) return 65535;
  const double z = camera.background->depth[pixel] * camera.depth_unit_m;
  const double margin = camera.background->margin_m * std::max(1.0, z * z);
  // The slack keeps a margin that is a whole number of units from being lost to the rounding of the division.
  const double limit = std::ceil((z - margin) / camera.depth_unit_m - 1e-6) - 1;
  return static_cast<std::uint16_t>(std::clamp(limit, 0.0, 65534.0));
}

}  // namespace palpa::sensing
