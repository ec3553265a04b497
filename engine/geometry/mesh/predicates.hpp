// On which side of a plane or line a point lies. Exact signs for double coordinates, regardless of rounding.
#pragma once

#include "base/math.hpp"

namespace palpa::geometry {

/// The sign of det(b - a, c - a, d - a): 1 if d lies on the side of the triangle from which its corners a, b, c run
/// counter-clockwise, -1 on the other side, 0 in its plane. Exact unless numbers over- or underflow. Method: a filter
/// in floating point, then expansions (Shewchuk 1997).
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of det(b - a, c - a): 1 if a, b, c run counter-clockwise, 0 if they are collinear. Exact likewise.
int orient2d(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace palpa::geometry
