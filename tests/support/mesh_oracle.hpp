// The inside of a closed mesh and the depth in it, in double precision and by other means than the engine's: the
// nearest of all triangles, and the generalized winding number (Jacobson et al. 2013). A tree of boxes leaves out
// triangles that cannot be the nearest, and sums the winding of far ones as dipoles (Barill et al. 2018).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::test {

class MeshOracle {
 public:
  explicit MeshOracle(const geometry::Mesh& mesh);

  /// Metres to the nearest triangle; `most` if none is nearer than that.
  double distance(const Vec3& point, double most = std::numeric_limits<double>::infinity()) const;
  /// How often the mesh winds around the point: about 1 inside, 0 outside. A node is treated as a dipole if the point
  /// is farther than `far` times its radius; infinity sums every triangle.
  double winding(const Vec3& point, double far = 3) const;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 low, high;
    Vec3 centre;  ///< of its triangles' areas
    Vec3 area;    ///< sum of their normals times their areas
    double radius = 0;
    std::uint32_t first = 0, count = 0;  ///< triangles; count 0: children are `first` and `first + 1`
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace palpa::test
