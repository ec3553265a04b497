#include "sensing/lens.hpp"

#include <algorithm>
#include <cmath>

namespace palpa::sensing {

/// OpenCV's model (calib3d, "Camera Calibration and 3D Reconstruction") with its derivatives.
struct Lens::Value {
  Vec2 distorted;
  double xx, xy, yy;  ///< its symmetric Jacobian

  /// Both principal stretches are positive, so the image keeps its orientation here.
  bool unfolded() const { return xx + yy > 0 && determinant() > 1e-9; }
  double determinant() const { return xx * yy - xy * xy; }
};

Lens::Value Lens::evaluate(const Vec2& ray) const {
  const auto& [k1, k2, p1, p2, k3] = k_;
  const double x = ray.x, y = ray.y, r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // 2 d radial / d r2
  Value out;
  out.distorted = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                   y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  out.xx = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x;
  out.xy = x * y * slope + 2 * p1 * x + 2 * p2 * y;
  out.yy = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return out;
}

Lens::Lens(const std::array<double, 5>& distortion, bool prepare)
    : k_(distortion), identity_(std::all_of(k_.begin(), k_.end(), [](double k) { return k == 0; })) {
  if (prepare && !identity_) find_bounds();
}

Vec2 Lens::apply(const Vec2& ray) const {
  return evaluate(ray).distorted;
}

void Lens::find_bounds() {
  const auto& [k1, k2, p1, p2, k3] = k_;
  const double tangential = std::abs(p1) + std::abs(p2);
  bool safe = true;
  double reach = 0;
  for (double r = 1e-4; r < 100; r *= 1.005) {
    const double r2 = r * r;
    const double across = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double along = 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3));
    const double smaller = std::min(across, along), tilt = 8 * tangential * r;  // bounds the norm of the tangential
                                                                                // part
    safe = safe && smaller - tilt > 1e-3;
    if (safe) safe_radius_ = r;
    reach = std::max(reach, r * 1.005 * std::abs(across) + 4 * tangential * r2);
    if (smaller + tilt < 0) {  // folded in every direction, so no ray comes from beyond
      target_radius_ = reach * 1.05 + 1e-6;
      return;
    }
  }
}

std::optional<Vec2> Lens::newton(const Vec2& target, Vec2 ray) const {
  double best = 1e300;
  for (int step = 0; step < 12; ++step) {
    const Value value = evaluate(ray);
    if (!value.unfolded()) return std::nullopt;
    const Vec2 miss = target - value.distorted;
    const double size = std::abs(miss.x) + std::abs(miss.y);
    // Convergence is quadratic until rounding ends it.
    if (size <= 1e-14 || (size <= 1e-12 && size >= best)) return ray;
    best = std::min(best, size);
    ray += Vec2(value.yy * miss.x - value.xy * miss.y, value.xx * miss.y - value.xy * miss.x) / value.determinant();
  }
  return best <= 1e-10 ? std::optional(ray) : std::nullopt;
}

/// Whether the straight line from the axis to the ray stays unfolded. Excludes solutions beyond a fold.
bool Lens::reachable(const Vec2& ray) const {
  if (ray.x * ray.x + ray.y * ray.y < safe_radius_ * safe_radius_) return true;
  constexpr int samples = 12;
  for (int i = 1; i <= samples; ++i) {
    if (!evaluate(ray * (static_cast<double>(i) / samples)).unfolded()) return false;
  }
  return true;
}

std::optional<Vec2> Lens::undo(const Vec2& target, const Vec2& guess) const {
  if (identity_) return target;
  if (target.x * target.x + target.y * target.y > target_radius_ * target_radius_) return std::nullopt;
  if (const auto direct = newton(target, guess); direct && reachable(*direct)) return direct;
  // Follow the ray outwards from the axis, where the model is the identity.
  constexpr int legs = 32;
  Vec2 ray{0, 0};
  for (int leg = 1; leg <= legs; ++leg) {
    const auto next = newton(target * (static_cast<double>(leg) / legs), ray);
    if (!next) return std::nullopt;
    ray = *next;
  }
  return reachable(ray) ? std::optional(ray) : std::nullopt;
}

}  // namespace palpa::sensing
