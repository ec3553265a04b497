#include "sensing/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace palpa::sensing {
namespace {

struct Distorted {
  Vec2 value;
  double xx, xy, yx, yy;  // Jacobian: d value.x / d x, d value.x / d y, ...
};

/// OpenCV's model (calib3d, "Camera Calibration and 3D Reconstruction") with its derivatives.
Distorted distort(const std::array<double, 5>& k, const Vec2& n) {
  const auto& [k1, k2, p1, p2, k3] = k;
  const double x = n.x, y = n.y, r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // d radial / d r2, times 2
  Distorted out;
  out.value = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
               y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  out.xx = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x;
  out.xy = x * y * slope + 2 * p1 * x + 2 * p2 * y;
  out.yx = out.xy;
  out.yy = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return out;
}

/// The lens keeps its orientation here: both principal stretches are positive (the Jacobian is symmetric).
bool unfolded(const Distorted& d) {
  return d.xx + d.yy > 0 && d.xx * d.yy - d.xy * d.yx > 1e-9;
}

/// Newton from `start`; nullopt where it does not settle within a few steps or leaves the unfolded region.
std::optional<Vec2> newton(const std::array<double, 5>& k, const Vec2& target, Vec2 start) {
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 20; ++step) {
    const Distorted d = distort(k, start);
    if (!unfolded(d)) return std::nullopt;
    const Vec2 miss = target - d.value;
    const double size = std::abs(miss.x) + std::abs(miss.y);
    // Quadratic convergence ends at rounding: the first step that no longer gains is the answer.
    if (size <= 1e-15 || (size <= 1e-12 && size >= best)) return start;
    best = std::min(best, size);
    const double det = d.xx * d.yy - d.xy * d.yx;
    start += Vec2(d.yy * miss.x - d.xy * miss.y, d.xx * miss.y - d.yx * miss.x) / det;
  }
  return best <= 1e-10 ? std::optional(start) : std::nullopt;
}

/// Whether the straight way from the centre to `n` stays unfolded: rules out solutions beyond the fold.
bool reachable(const std::array<double, 5>& k, const Vec2& n) {
  constexpr int samples = 12;
  for (int i = 1; i <= samples; ++i) {
    if (!unfolded(distort(k, n * (static_cast<double>(i) / samples)))) return false;
  }
  return true;
}

}  // namespace

Vec2 project(const Camera& camera, const Vec3& point_camera) {
  const Vec2 n = distort(camera.distortion, Vec2(point_camera) / point_camera.z).value;
  return {camera.fx * n.x + camera.cx, camera.fy * n.y + camera.cy};
}

Vec2 undistort(const Camera& camera, const Vec2& pixel) {
  const Vec2 target{(pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy};
  const auto& k = camera.distortion;
  if (std::all_of(k.begin(), k.end(), [](double value) { return value == 0; })) return target;
  if (const auto direct = newton(k, target, target); direct && reachable(k, *direct)) return *direct;
  // Follow the ray outwards from the centre, where the model is the identity.
  constexpr int legs = 64;
  Vec2 n{0, 0};
  for (int leg = 1; leg <= legs; ++leg) {
    const auto next = newton(k, target * (static_cast<double>(leg) / legs), n);
    if (!next) return Vec2(std::numeric_limits<double>::quiet_NaN());
    n = *next;
  }
  return reachable(k, n) ? n : Vec2(std::numeric_limits<double>::quiet_NaN());
}

Vec3 deproject(const Camera& camera, double u, double v, std::uint16_t depth) {
  const double z = depth * camera.depth_unit_m;
  const Vec2 n = undistort(camera, {u, v});
  return transform_point(camera.T_world_camera, Vec3(n * z, z));
}

std::uint32_t first_valid_depth(const Camera& camera) {
  // The slack keeps a range that is a whole number of units from being lost to the division's rounding.
  const double steps = std::ceil(camera.min_range_m / camera.depth_unit_m - 1e-6);
  return static_cast<std::uint32_t>(std::clamp(steps, 1.0, 65536.0));
}

}  // namespace palpa::sensing
