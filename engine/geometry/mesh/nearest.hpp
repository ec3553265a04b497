// How far a point is from a soup of triangles.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// The point of triangle a, b, c that is nearest to p; right also for triangles without area.
Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// A tree of boxes over a mesh's triangles. The mesh must outlive it.
class NearestTriangle {
 public:
  /// `mesh` has at least one triangle.
  explicit NearestTriangle(const Mesh& mesh) : mesh_(&mesh), tree_(mesh) {}

  /// Metres to the nearest triangle, or `most` where that is less.
  double distance(const Vec3& point, double most = std::numeric_limits<double>::infinity()) const;

  /// The nearest triangle, of several one of them, its nearest point, and how far that is in metres.
  struct Found {
    std::uint32_t triangle = 0;
    Vec3 point{0};
    double distance = 0;
  };
  /// Nothing where none is nearer than `most`.
  std::optional<Found> find(const Vec3& point, double most = std::numeric_limits<double>::infinity()) const;

 private:
  const Mesh* mesh_;
  Bvh tree_;
};

}  // namespace palpa::geometry
