#include "hostile_models.hpp"

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "support/shapes.hpp"

namespace palpa::test::hostile {

using geometry::Mesh;

Mesh rods(int count) {
  const int per_side = static_cast<int>(std::ceil(std::sqrt(count)));
  const Vec3 a = glm::normalize(Vec3(1, -1, 0)), b = glm::normalize(Vec3(1, 1, -2)), d = glm::normalize(Vec3(1, 1, 1));
  Mesh all;
  for (int i = 0; i < count; ++i) {
    Mesh rod = box({0, 0, -1}, {0.15 / per_side, 0.15 / per_side, 1});
    for (Vec3& p : rod.positions)
      p = a * (p.x + 0.5 * (i % per_side) / per_side) + b * (p.y + 0.5 * (i / per_side) / per_side) + d * p.z;
    geometry::append(all, rod);
  }
  return all;
}

Mesh nested(int count, bool in_turn) {
  Mesh all;
  for (int i = 0; i < count; ++i) {
    const double half = 0.01 + 0.49 * i / (count - 1);
    Mesh shell = box(Vec3(-half), Vec3(half));
    if (in_turn && (count - 1 - i) % 2 == 1) geometry::flip(shell);
    geometry::append(all, shell);
  }
  return all;
}

Mesh needles(std::uint32_t count) {
  Mesh fan;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double at = (k + 1) * 1e-13;
    fan.positions.emplace_back(k % 2 == 0 ? -1.0 : 1.0, at, at * (k % 3 + 1));
    fan.triangles.emplace_back(k, (k + 1) % count, count);
    fan.triangles.emplace_back((k + 1) % count, k, count + 1);
  }
  fan.positions.emplace_back(0, 0, 0);
  fan.positions.emplace_back(0, 0, 1);
  return fan;
}

GltfBuilder many_bones(int joints) {
  GltfBuilder builder;
  builder.add_mesh(box({0, 0, 0}, {0.1, 0.1, 0.1}));
  std::vector<float> weights, inverse;
  for (int i = 0; i < 8; ++i)
    weights.insert(weights.end(), {1, 0, 0, 0});
  for (int i = 0; i < joints; ++i)
    inverse.insert(inverse.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  auto& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = builder.add_accessor(std::vector<unsigned char>(32, 0), 5121, 8, "VEC4");
  attributes["WEIGHTS_0"] = builder.add_accessor(bytes_of(weights), 5126, 8, "VEC4");
  GltfBuilder::Json all = GltfBuilder::Json::array();
  for (int i = 0; i < joints; ++i)
    all.push_back(builder.add_node({{"name", "joint"}}));
  const int matrices = builder.add_accessor(bytes_of(inverse), 5126, static_cast<std::size_t>(joints), "MAT4");
  builder.doc["skins"] = GltfBuilder::Json::array({{{"joints", all}, {"inverseBindMatrices", matrices}}});
  for (int i = 0; i < joints; ++i)
    builder.add_node({{"mesh", 0}, {"skin", 0}});
  return builder;
}

}  // namespace palpa::test::hostile
