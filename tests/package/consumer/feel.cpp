// A user's program: how deep is a point in a cube of 4 cm?
#include <cmath>
#include <cstdio>

#include "geometry/solid.hpp"

int main() {
  using palpa::Vec3;
  palpa::geometry::Scene scene{"cube", {{"cube", {}}}};
  palpa::geometry::Mesh& cube = scene.meshes.front().mesh;
  for (int i = 0; i < 8; ++i) {
    cube.positions.push_back(Vec3(i & 1 ? 0.02 : -0.02, i & 2 ? 0.02 : -0.02, i & 4 ? 0.02 : -0.02));
  }
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

  const auto solids = palpa::geometry::make_solids(scene);
  const double depth = palpa::geometry::depth(solids.at(0), Vec3(0.001, 0.018, -0.003));
  std::printf("%s: 2 mm below the top the depth is %.17g m\n", solids[0].name.c_str(), depth);
  return std::abs(depth - 0.002) < 1e-12 ? 0 : 1;
}
