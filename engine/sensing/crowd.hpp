// Draws triangles of which very many lie behind each other: those nearer first, with a tree of boxes over the image
// that knows how far each box is drawn already, so that what is hidden, or passes a box by, costs nothing there.
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

/// A triangle, and the pixels that may show it: those of `box`, of these only tiles whose rays reach from `low` to
/// `high`.
struct CrowdTriangle {
  TriangleEdges edges;
  PixelBox box;
  Vec2 low{-std::numeric_limits<double>::infinity()}, high{std::numeric_limits<double>::infinity()};
  double near = 0;  ///< the depth of its nearest corner
};

/// Draws `triangles` over `depth` and `slant` (as in DepthImage): the same bytes as drawing one after the other, where
/// one replaces what is there if its depth, not yet rounded, is below. Adds the rays that were cast to `looks`, and
/// returns false, with the image undefined, as soon as these are more than `most`.
bool draw_crowd(const CameraTable& table, const glm::vec2* rays, std::span<const CrowdTriangle> triangles,
                std::span<float> depth, std::span<float> slant, std::uint64_t most, std::uint64_t& looks);

}  // namespace palpa::sensing
