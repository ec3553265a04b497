#include "geometry/mesh/icosphere.hpp"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::geometry {

Mesh icosphere(double radius, int divisions) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const std::array<Vec3, 12> corners{{{-1, g, 0},
                                      {1, g, 0},
                                      {-1, -g, 0},
                                      {1, -g, 0},
                                      {0, -1, g},
                                      {0, 1, g},
                                      {0, -1, -g},
                                      {0, 1, -g},
                                      {g, 0, -1},
                                      {g, 0, 1},
                                      {-g, 0, -1},
                                      {-g, 0, 1}}};
  constexpr unsigned faces[20][3]{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  Mesh mesh;
  for (const auto& face : faces) {
    const auto at = [&](int b, int c) {
      const Vec3 flat = corners[face[0]] * static_cast<double>(divisions - b - c) +
                        corners[face[1]] * static_cast<double>(b) + corners[face[2]] * static_cast<double>(c);
      return radius * glm::normalize(flat);
    };
    const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
      const auto first = static_cast<unsigned>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), {p, q, r});
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    };
    for (int b = 0; b < divisions; ++b) {
      for (int c = 0; c < divisions - b; ++c) {
        add(at(b, c), at(b + 1, c), at(b, c + 1));
        if (b + c < divisions - 1) add(at(b + 1, c), at(b + 1, c + 1), at(b, c + 1));
      }
    }
  }
  return weld(mesh, radius * 1e-9);
}

}  // namespace palpa::geometry
