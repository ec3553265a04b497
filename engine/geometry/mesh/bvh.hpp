// A mesh's triangles in a binary tree of boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

class Bvh {
 public:
  /// The maximum number of triangles in a leaf.
  static constexpr std::uint32_t leaf_size = 4;

  struct Node {
    Box box;
    std::uint32_t begin, end;  ///< the node's triangles: a range of order()
    std::uint32_t second;      ///< the first child follows its parent; 0 in leaves
  };

  /// Splits at the median of the triangles' centres along the longest axis, on all cores; the result is the same for
  /// any number of cores. `mesh` has at least one triangle.
  explicit Bvh(const Mesh& mesh);

  /// Depth first; the first node is the root.
  std::span<const Node> nodes() const { return nodes_; }
  /// The mesh's triangles, leaf after leaf: triangles near each other in space are near each other here.
  std::span<const std::uint32_t> order() const { return order_; }

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

/// Squared distance of a point from a box; 0 inside.
inline double distance2(const Box& box, const Vec3& p) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double below = box.low[i] - p[i], above = p[i] - box.high[i];
    const double out = below > above ? below : above;
    sum += out > 0 ? out * out : 0;
  }
  return sum;
}

}  // namespace palpa::geometry
