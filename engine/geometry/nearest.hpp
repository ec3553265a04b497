// How far a point is from a soup of triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.hpp"

namespace palpa::geometry {

/// The point of triangle a, b, c that is nearest to p; right also for triangles without area.
Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// A tree of boxes over a mesh's triangles. The mesh must outlive it.
class NearestTriangle {
 public:
  explicit NearestTriangle(const Mesh& mesh);

  /// Metres to the nearest triangle; infinite for a mesh without triangles.
  double distance(const Vec3& point) const;

 private:
  struct Node {
    Box box;
    std::uint32_t begin, end;
    std::uint32_t second = 0;  ///< the first child follows its parent; 0 in leaves
  };
  void build(std::uint32_t begin, std::uint32_t end, std::vector<Vec3>& centres);

  const Mesh* mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace palpa::geometry
