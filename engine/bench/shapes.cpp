#include "bench/shapes.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace palpa::bench {

geometry::Mesh dented_ball(std::uint32_t faces) {
  const auto rings = static_cast<std::uint32_t>(std::sqrt(faces / 4.0)), segments = 2 * rings;
  const auto radius = [](const Vec3& n) {
    const double dents = std::sin(19 * n.x) * std::sin(17 * n.z) * std::cos(23 * n.y);
    return 0.05 + 0.0015 * (dents - 1) * (1 - n.y * n.y);  // none at the top, where the finger is
  };
  geometry::Mesh mesh;
  const auto add = [&](const Vec3& n) {
    mesh.positions.emplace_back(glm::vec3(radius(n) * n - Vec3(0, 0.05, 0)));  // rounded as in a file
  };
  add({0, 1, 0});
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t k = 0; k < segments; ++k) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * k / segments;
      add({std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)});
    }
  }
  add({0, -1, 0});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t ring, std::uint32_t k) { return 1 + (ring - 1) * segments + k % segments; };
  for (std::uint32_t k = 0; k < segments; ++k) {
    mesh.triangles.emplace_back(0U, at(1, k), at(1, k + 1));
    mesh.triangles.emplace_back(last, at(rings - 1, k + 1), at(rings - 1, k));
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k), at(i, k + 1));
      mesh.triangles.emplace_back(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
    }
  }
  return mesh;
}

geometry::Mesh box_mesh(const Vec3& low, const Vec3& high) {
  geometry::Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

std::vector<geometry::Solid> box_solid(const Vec3& low, const Vec3& high) {
  return geometry::make_solids({"box", {{"box", box_mesh(low, high)}}});
}

std::vector<glm::vec3> finger_points(std::uint32_t count, double tip) {
  constexpr double radius = 0.008, length = 0.06;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));  // the golden angle spreads them evenly
  std::vector<glm::vec3> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double up = (length + radius) * (i + 0.5) / count;
    const double around = up < radius ? std::sqrt(radius * radius - (radius - up) * (radius - up)) : radius;
    points.emplace_back(around * std::cos(turn * i), tip + up, around * std::sin(turn * i));
  }
  return points;
}

}  // namespace palpa::bench
