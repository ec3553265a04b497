// Distance of a point from an unordered set of triangles.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// The point of triangle a, b, c that is nearest to p; correct also for triangles with zero area.
Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// A tree of boxes over a mesh's triangles. The mesh must outlive it.
class NearestTriangle {
 public:
  /// `mesh` has at least one triangle.
  explicit NearestTriangle(const Mesh& mesh) : mesh_(&mesh), tree_(mesh) {}

  /// Metres to the nearest triangle, or `most` if that is smaller.
  double distance(const Vec3& point, double most = std::numeric_limits<double>::infinity()) const;

  /// The nearest triangle (one of them if several are equally near), its nearest point, and the distance in metres.
  struct Found {
    std::uint32_t triangle = 0;
    Vec3 point{0};
    double distance = 0;
  };
  /// nullopt if no triangle is nearer than `most`.
  std::optional<Found> find(const Vec3& point, double most = std::numeric_limits<double>::infinity()) const;

 private:
  const Mesh* mesh_;
  Bvh tree_;
};

}  // namespace palpa::geometry
