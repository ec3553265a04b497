// Meshes of many kinds, and how deep a point lies in one by an independent double-precision computation.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::touch::test {

/// A tube around a (2,3) torus knot, some 40 mm across.
geometry::Mesh knot(int around, int across);
/// A 40 mm cube with a notch of 15 mm cut out of its top, along z.
geometry::Mesh notched_cube();
/// A ball of 20 mm with a cavity of 15 mm, whose shell faces inwards.
geometry::Mesh hollow_ball();
/// 80 x 0.4 x 60 mm.
geometry::Mesh thin_plate();
/// 10 mm radius, 60 mm long; each side one pair of needles, each lid a fan.
geometry::Mesh needle_cylinder(int segments);
/// Every triangle cut into four.
geometry::Mesh subdivided(const geometry::Mesh& mesh);
/// Turned about all axes, shifted, and rounded to single precision as a file has it.
geometry::Mesh tilted(geometry::Mesh mesh, const Vec3& shift);

/// Points within some 3 mm of the surface, on both sides, evenly over its area.
std::vector<glm::vec3> points_near(const geometry::Mesh& mesh, std::uint32_t count, unsigned seed);

/// Signed distance in double precision: the nearest triangle, and the generalized winding number (Jacobson 2013). Plain
/// bins spare looking at triangles that cannot matter; the inside is told by the parity of crossings along x, and by
/// the winding number over all triangles where `thorough` or where that line grazes an edge. Shares nothing with the
/// engine.
class Truth {
 public:
  explicit Truth(const geometry::Mesh& mesh);
  /// Positive inside. Points farther than 8 mm from the surface may be given any depth beyond that, with the right
  /// sign.
  double depth(const Vec3& p, bool thorough) const;

 private:
  double distance(const Vec3& p) const;
  bool winds(const Vec3& p) const;
  int crossings(const Vec3& p) const;  // -1: cannot tell
  std::size_t bin(int y, int z) const;
  std::size_t cell(int x, int y, int z) const;

  const geometry::Mesh* mesh_;
  Box box_;
  double side_ = 0;
  int nx_ = 1, ny_ = 1, nz_ = 1;
  std::vector<std::vector<std::uint32_t>> bins_, cells_;
};

}  // namespace palpa::touch::test
