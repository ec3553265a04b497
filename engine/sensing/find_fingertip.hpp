// The tip of a finger in the image of a camera whose pose is not known: for `palpa calibrate --by-touch`. Metres, in
// the camera's frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensing/camera.hpp"

namespace palpa::sensing {

/// What is nearer than the camera's background, within 1 m, without lone pixels and silhouettes: the hand.
/// `rays` are make_rays() of this camera alone.
struct RayTables;
std::vector<Vec3> hand_points(const Camera& camera, const RayTables& rays, std::span<const std::uint16_t> depth);

/// The end of a finger as a ball.
struct Fingertip {
  Vec3 centre_m{};
  double radius_m = 0;
  double rms_m = 0;  ///< distance of its points from the ball
};

/// The end of the hand that is farthest along `way`, a unit vector: where a finger points to. nullopt if there are too
/// few points, or no end of a finger's size. The ball fits the points with the least squares, with less weight for
/// those far off it; its radius is from 5 to 11 mm.
std::optional<Fingertip> find_fingertip(std::span<const Vec3> hand, const Vec3& way);

}  // namespace palpa::sensing
