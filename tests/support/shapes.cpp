#include "support/shapes.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace palpa::test {

using geometry::Mesh;

Mesh box(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                (i & 4) != 0 ? high.z : low.z);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh prism(const std::vector<Vec2>& outline, const std::vector<glm::uvec3>& triangles, double low, double high) {
  const auto n = static_cast<std::uint32_t>(outline.size());
  Mesh mesh;
  for (const double z : {low, high}) {
    for (const Vec2& p : outline)
      mesh.positions.emplace_back(p.x, p.y, z);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.emplace_back(i, next, next + n);
    mesh.triangles.emplace_back(i, next + n, i + n);
  }
  for (const glm::uvec3& t : triangles) {
    mesh.triangles.emplace_back(t[0], t[2], t[1]);
    mesh.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  }
  return mesh;
}

Mesh ell() {
  return prism({{-0.03, -0.04}, {0.03, -0.04}, {0.03, -0.02}, {0, -0.02}, {0, 0}, {-0.03, 0}},
               {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}, -0.02, 0.02);
}

Mesh sphere(double radius, int rings, int segments) {
  constexpr double pi = std::numbers::pi;
  Mesh mesh;
  mesh.positions.emplace_back(0, 0, radius);
  for (int i = 1; i < rings; ++i) {
    for (int k = 0; k < segments; ++k) {
      const double theta = pi * i / rings, phi = 2 * pi * k / segments;
      mesh.positions.emplace_back(radius * std::sin(theta) * std::cos(phi), radius * std::sin(theta) * std::sin(phi),
                                  radius * std::cos(theta));
    }
  }
  mesh.positions.emplace_back(0, 0, -radius);
  const auto south = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [&](int ring, int k) { return static_cast<std::uint32_t>(1 + (ring - 1) * segments + k % segments); };
  for (int k = 0; k < segments; ++k) {
    mesh.triangles.emplace_back(0, at(1, k), at(1, k + 1));
    mesh.triangles.emplace_back(south, at(rings - 1, k + 1), at(rings - 1, k));
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k), at(i, k + 1));
      mesh.triangles.emplace_back(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
    }
  }
  return mesh;
}

Mesh torus(double radius, double tube, int segments) {
  constexpr double pi = std::numbers::pi;
  Mesh mesh;
  for (int i = 0; i < segments; ++i) {
    for (int k = 0; k < segments; ++k) {
      const double around = 2 * pi * i / segments, across = 2 * pi * k / segments;
      const double r = radius + tube * std::cos(across);
      mesh.positions.emplace_back(r * std::cos(around), r * std::sin(around), tube * std::sin(across));
    }
  }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>((i % segments) * segments + k % segments); };
  for (int i = 0; i < segments; ++i) {
    for (int k = 0; k < segments; ++k) {
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k), at(i, k + 1));
      mesh.triangles.emplace_back(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
    }
  }
  return mesh;
}

Mesh unshared(const Mesh& mesh) {
  Mesh out;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (int i = 0; i < 3; ++i)
      out.positions.push_back(mesh.positions[t[i]]);
    out.triangles.emplace_back(first, first + 1, first + 2);
  }
  return out;
}

Mesh divided(const Mesh& mesh, int times) {
  if (times == 0) return mesh;
  Mesh finer;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const auto first = static_cast<std::uint32_t>(finer.positions.size());
    finer.positions.insert(finer.positions.end(), {a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0});
    for (const glm::uvec3& small : {glm::uvec3(0, 3, 5), glm::uvec3(3, 1, 4), glm::uvec3(5, 4, 2), glm::uvec3(3, 4, 5)})
      finer.triangles.push_back(small + first);
  }
  return divided(geometry::weld(finer, 1e-9), times - 1);
}

Mesh divided_box(const Vec3& half, int times) {
  return divided(box(-half, half), times);
}

Mesh squared_cube(double side, int squares) {
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const bool high = face % 2 == 1;
    const auto at = [&](int i, int j) {
      Vec3 p;
      p[axis] = high ? side / 2 : -side / 2;
      p[(axis + 1) % 3] = side * i / squares - side / 2;
      p[(axis + 2) % 3] = side * j / squares - side / 2;
      return p;
    };
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const auto first = static_cast<unsigned>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), {a, high ? b : c, high ? c : b});
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    };
    for (int i = 0; i < squares; ++i) {
      for (int j = 0; j < squares; ++j) {
        add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return geometry::weld(mesh, side * 1e-6);
}

Mesh transformed(Mesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : mesh.positions)
    p = map(p);
  return mesh;
}

Mesh rounded(const Mesh& mesh) {
  Mesh out = mesh;
  for (Vec3& p : out.positions) {
    for (int i = 0; i < 3; ++i) {
      // Volatile: GCC 12's vectorizer of straight-line code drops a conversion to float and back.
      const volatile auto single = static_cast<float>(p[i]);
      p[i] = single;
    }
  }
  return out;
}

}  // namespace palpa::test
