// The flat patches of what a depth camera sees.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/parts/convex.hpp"
#include "sensing/still_image.hpp"

namespace palpa::sensing {

struct FlatPatch {
  geometry::Plane plane;  ///< camera frame, its normal towards the camera
  Vec3 middle{0};         ///< the one of its points that is nearest to their centroid, which may lie in a hole
  std::uint32_t points = 0;
};

struct FlatOptions {
  std::uint32_t least_points = 150;
  std::size_t most = 60;  ///< the largest ones
};

/// Regions of neighbouring pixels that lie in one plane within the image's own noise, grown from where it is flattest.
/// The depths of a plane are linear in 1 / z over the rays, and so is a stereo camera's noise, so planes are fitted
/// there. Each pixel belongs to at most one; the largest come first. The same image gives the same patches.
std::vector<FlatPatch> find_flat_patches(const StillImage& image, const FlatOptions& options = {});

}  // namespace palpa::sensing
