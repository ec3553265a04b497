// The rays of a camera's pixels in double precision, one by one.
#pragma once

#include <limits>

#include "sensing/camera.hpp"
#include "sensing/lens.hpp"

namespace palpa::test {

/// Normalised coordinates (x/z, y/z) of the ray through a pixel. Both are NaN if no ray of the lens model reaches that
/// pixel, or only a ray beyond the circle where the model folds back on itself.
inline Vec2 undistort(const sensing::Camera& camera, const Vec2& pixel) {
  const Vec2 target{(pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy};
  return sensing::Lens(camera.distortion, false)
      .undo(target, target)
      .value_or(Vec2(std::numeric_limits<double>::quiet_NaN()));
}

/// World point of pixel (u, v) at raw depth d > 0.
inline Vec3 deproject(const sensing::Camera& camera, double u, double v, std::uint16_t depth) {
  const double z = depth * camera.depth_unit_m;
  return transform_point(camera.T_world_camera, Vec3(undistort(camera, {u, v}) * z, z));
}

}  // namespace palpa::test
