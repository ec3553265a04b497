// The flat patches in a depth camera's image.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/parts/convex.hpp"
#include "sensing/still_image.hpp"

namespace palpa::sensing {

struct FlatPatch {
  geometry::Plane plane;  ///< camera frame, its normal towards the camera
  Vec3 middle{0};         ///< the point nearest to the centroid, which itself may lie in a hole
  std::uint32_t points = 0;
};

/// Regions of neighbouring pixels that lie in one plane within the image's own noise, grown from the flattest places. A
/// plane is linear in 1 / z over the rays, and a stereo camera's noise is even in 1 / z. Planes are therefore fitted in
/// 1 / z. Each pixel belongs to at most one patch. Returns the 60 largest of at least 150 points, the largest first.
/// The same image gives the same patches.
std::vector<FlatPatch> find_flat_patches(const StillImage& image);

}  // namespace palpa::sensing
