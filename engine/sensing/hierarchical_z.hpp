// A hierarchical z-buffer (Greene, Kass and Miller 1993), for meshes in which very many triangles lie behind each
// other. Nearer triangles are drawn first. A tree of boxes over the image keeps the farthest depth drawn in each box.
// Triangles that are hidden in a box, or miss it, cost nothing there.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <vector>

#include "sensing/pixel_box.hpp"
#include "sensing/rays.hpp"
#include "sensing/triangle_edges.hpp"

namespace palpa::sensing {

/// A triangle and the pixels that may show it: the pixels in `box`, and of these only tiles whose rays reach from `low`
/// to `high`.
struct PlacedTriangle {
  TriangleEdges edges;
  PixelBox box;
  Vec2 low{-std::numeric_limits<double>::infinity()}, high{std::numeric_limits<double>::infinity()};
  double near = 0;  ///< the depth of its nearest corner
};

/// Draws `triangles` over `depth` and `slant` (as in DepthImage). The bytes are the same as if each triangle were drawn
/// in turn and replaced a pixel whenever its unrounded depth is smaller. Adds the number of cast rays to `looks`, and
/// returns false, with the image undefined, as soon as `looks` exceeds `most`.
bool draw_hierarchical_z(const CameraTable& table, const glm::vec2* rays, std::span<const PlacedTriangle> triangles,
                         std::span<float> depth, std::span<float> slant, std::uint64_t most, std::uint64_t& looks);

}  // namespace palpa::sensing
