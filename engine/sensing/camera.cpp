#include "sensing/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>

#include "sensing/lens.hpp"

namespace palpa::sensing {
namespace {

std::string implausible_focal_lengths(const Camera& camera) {
  constexpr double least_ratio = 2.5;             // pixels that are added up in one direction have twice the length
  constexpr double widest = 8, narrowest = 0.08;  // size / focal length: 152 and 4.6 degrees
  const double ratio = std::max(camera.fx / camera.fy, camera.fy / camera.fx);
  if (ratio > least_ratio) {
    return fmt::format("fx = {:g} and fy = {:g} differ by a factor of {:.3g}, but pixels are nearly square", camera.fx,
                       camera.fy, ratio);
  }
  const double wide = camera.width / camera.fx, high = camera.height / camera.fy;
  const bool is_wide = wide >= high;
  const double most = std::max(wide, high);
  if (most <= widest && most >= narrowest) return {};
  return fmt::format(
      "{} = {:g} makes the picture {:.3g} degrees {}; fx and fy are in pixels{}", is_wide ? "fx" : "fy",
      is_wide ? camera.fx : camera.fy, glm::degrees(2 * std::atan(most / 2)), is_wide ? "wide" : "high",
      most > widest ? ": a length in millimetres, divided by the width of a pixel of the sensor, or a fraction of the "
                      "picture, times its width"
                    : "");
}

/// How far from the picture's middle, at most, as a fraction of the sides.
double off_middle(const Camera& camera, double cx, double cy) {
  return std::max(std::abs((cx + 0.5) / camera.width - 0.5), std::abs((cy + 0.5) / camera.height - 0.5));
}

std::string implausible_principal_point(const Camera& camera) {
  constexpr double off = 0.05, corner = 0.05;
  constexpr double same_scale = 0.03, other_scale = 0.25;
  const double x = (camera.cx + 0.5) / camera.width, y = (camera.cy + 0.5) / camera.height;  // 0 to 1 in the picture
  const std::string given = fmt::format("cx = {:g} and cy = {:g}", camera.cx, camera.cy);
  const std::string middle = fmt::format("the middle of {}x{} pixels is ({:g}, {:g})", camera.width, camera.height,
                                         (camera.width - 1) / 2.0, (camera.height - 1) / 2.0);
  const double as_given = off_middle(camera, camera.cx, camera.cy);
  if (as_given > off && off_middle(camera, camera.cy, camera.cx) < as_given / 4)
    return fmt::format("{} look exchanged: {}", given, middle);
  const bool outside = x < 0 || x > 1 || y < 0 || y > 1;
  if (x > 0.5 && y > 0.5 && std::abs(x / y - 1) < same_scale && 2 * x - 1 > other_scale) {
    return fmt::format(
        "{} {}are the middle of {:.0f}x{:.0f} pixels, but the pictures have {}x{}: scale fx, fy, cx and "
        "cy to this size",
        given, outside ? "lie outside the picture; they " : "", 2 * camera.cx + 1, 2 * camera.cy + 1, camera.width,
        camera.height);
  }
  if (outside) return fmt::format("{} lie outside the picture: {}", given, middle);
  if (x < corner && y < corner && as_given > off)
    return fmt::format("{} lie in the picture's corner; they are in pixels: {}", given, middle);
  return {};
}

}  // namespace

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

std::string implausible_lens(const Camera& camera) {
  const std::string focal = implausible_focal_lengths(camera), point = implausible_principal_point(camera);
  return focal + (focal.empty() || point.empty() ? "" : "; ") + point;
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
