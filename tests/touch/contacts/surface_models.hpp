// Meshes of many kinds, and the depth of a point in a mesh by an independent double-precision computation.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::touch::test {

/// A 40 mm cube with a notch of 15 mm cut out of its top, along z.
geometry::Mesh notched_cube();
/// A ball of 20 mm with a cavity of 15 mm, whose shell faces inwards.
geometry::Mesh hollow_ball();
/// 80 x 0.4 x 60 mm.
geometry::Mesh thin_plate();
/// 10 mm radius, 60 mm long; each side one pair of needles, each lid a fan.
geometry::Mesh needle_cylinder(int segments);
/// Twelve sharp spikes of 40 mm with gorges between them, 25 mm high.
geometry::Mesh spikes();
/// Ridges and hollows all over, nowhere flat; 30 mm radius.
geometry::Mesh star();
/// Turned about all axes, shifted, and rounded to single precision as a file has it.
geometry::Mesh tilted(const geometry::Mesh& mesh, const Vec3& shift);

/// Points within about 3 mm of the surface, on both sides, evenly over its area.
std::vector<glm::vec3> points_near(const geometry::Mesh& mesh, std::uint32_t count, unsigned seed);

/// Signed distance in double precision: the nearest triangle, and the generalized winding number (Jacobson 2013). Plain
/// bins leave out triangles that cannot matter. The parity of crossings along x decides the inside. If `thorough`, or
/// if that line grazes an edge, the winding number over all triangles decides. It shares no code with the engine.
class Truth {
 public:
  explicit Truth(const geometry::Mesh& mesh);
  /// Positive inside. For points farther than 8 mm from the surface, the result may be any depth beyond that, with the
  /// right sign.
  double depth(const Vec3& p, bool thorough) const;

 private:
  double distance(const Vec3& p) const;
  bool winds(const Vec3& p) const;
  int crossings(const Vec3& p) const;  // -1: undecided
  std::size_t bin(int y, int z) const;
  std::size_t cell(int x, int y, int z) const;

  const geometry::Mesh* mesh_;
  Box box_;
  double side_ = 0;
  int nx_ = 1, ny_ = 1, nz_ = 1;
  std::vector<std::vector<std::uint32_t>> bins_, cells_;
};

}  // namespace palpa::touch::test
