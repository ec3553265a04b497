// The rigid transform that takes points to others with the least squares (Horn 1987).
#pragma once

#include <span>
#include <vector>

#include "base/math.hpp"

namespace palpa::setup {

struct RigidFit {
  Transform T_to_from{1.0};
  double residual_m = 0;      ///< rms distance that remains
  std::vector<double> off_m;  ///< the distances
};

/// Two lists of the same length, at least 3 points that are not on a line.
RigidFit fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to);

/// The same with less weight for points far off: 1 / (1 + (distance / `scale_m`)^2), again and again. The residual is
/// the plain rms of all points.
RigidFit fit_rigid_robustly(std::span<const Vec3> from, std::span<const Vec3> to, double scale_m);

/// The largest height over the longest side of any triangle of the points: how far they are from a line.
double height_of(std::span<const Vec3> points);

}  // namespace palpa::setup
