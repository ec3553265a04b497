// No file costs more than it weighs: families of models whose cost would grow faster than their size are answered, or
// refused with the limit that they exceed, within processor time and memory that grow as their size does.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "geometry/gltf_builder.hpp"
#include "geometry/gltf_write.hpp"
#include "process.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using geometry::Mesh;

class Cost : public testing::Test {
 protected:
  fs::path folder_ = scratch_folder("cost");

  Result touch(const fs::path& scene) const {
    RunOptions options;
    options.environment = {{"PALPA_CACHE", "off"}};
    const Result result = palpa({"touch", "--scene", scene.string(), "--points",
                                 source_file("assets/finger.ply").string(), "--penetration", "3mm", "--backend", "cpu"},
                                options);
    const double megabytes = static_cast<double>(fs::file_size(scene)) / 1e6;
    // What it takes of the processors: how long one waits depends on who else is there. Sanitizers make all slower and
    // fatter.
    EXPECT_LT(result.processor_s, (instrumented() ? 45 : 5) * (1 + megabytes)) << result.err;
    if (!instrumented()) {
      EXPECT_LT(result.peak_mib, 1e9 / (1 << 20)) << result.err;
    }
    return result;
  }
  Result touch(const Mesh& mesh) const {
    const geometry::SceneMesh scene{"it", mesh};
    geometry::write_glb(folder_ / "model.glb", std::span(&scene, 1));
    return touch(folder_ / "model.glb");
  }
  void expect_refused(const Result& result, const std::string& part) const {
    expect_failure(result, 4, "model.glb: mesh \"it\": ");
    expect_failure(result, 4, part);
  }
};

/// Parallel rods along a diagonal of the axes: their boxes all overlap, they do not.
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

/// Boxes within boxes, facing outwards and inwards in turn, or all outwards.
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

/// A fan of needles around one edge.
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

TEST_F(Cost, OfRodsSideBySide) {
  EXPECT_EQ(touch(rods(500)).exit_code, 0);
  expect_refused(touch(rods(5000)), "pairs of its 60000 triangles have boxes that overlap");
}

TEST_F(Cost, OfShellsWithinShells) {
  constexpr int many = instrumented() ? 1001 : 4001;
  EXPECT_EQ(touch(nested(301, true)).exit_code, 0);
  const Result deep = touch(nested(many, true));
  EXPECT_TRUE(deep.exit_code == 0 || deep.exit_code == 4) << deep.err;
  expect_failure(touch(nested(many, false)), 4, "has a shell inside another that faces the same way");
}

TEST_F(Cost, OfAFanOfNeedles) {
  expect_failure(touch(needles(50'000)), 4, "mesh \"it\" is flat");
}

TEST_F(Cost, OfManyNodesThatShowOneMesh) {
  GltfBuilder builder;
  const int mesh = builder.add_mesh(ell());
  for (int i = 0; i < 10'000; ++i)
    builder.add_node({{"mesh", mesh}, {"translation", {0.1 * (i % 100) - 5, 0.1 * (i / 100) - 5, 0}}});
  EXPECT_EQ(touch(builder.write_glb(folder_ / "model.glb")).exit_code, 0);
}

TEST_F(Cost, OfManyBones) {
  GltfBuilder builder;
  builder.add_mesh(box({0, 0, 0}, {0.1, 0.1, 0.1}));
  constexpr int joints = 5000;
  const auto accessor = [&](int view, int component, int count, const char* type) {
    builder.doc["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return builder.doc["accessors"].size() - 1;
  };
  std::vector<float> weights, inverse;
  for (int i = 0; i < 8; ++i)
    weights.insert(weights.end(), {1, 0, 0, 0});
  for (int i = 0; i < joints; ++i)
    inverse.insert(inverse.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  auto& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = accessor(builder.add_view(std::vector<unsigned char>(32, 0)), 5121, 8, "VEC4");
  attributes["WEIGHTS_0"] = accessor(builder.add_view(bytes_of(weights)), 5126, 8, "VEC4");
  GltfBuilder::Json all = GltfBuilder::Json::array();
  for (int i = 0; i < joints; ++i)
    all.push_back(builder.add_node({{"name", "joint"}}));
  builder.doc["skins"] = GltfBuilder::Json::array(
      {{{"joints", all},
        {"inverseBindMatrices", accessor(builder.add_view(bytes_of(inverse)), 5126, joints, "MAT4")}}});
  for (int i = 0; i < joints; ++i)
    builder.add_node({{"mesh", 0}, {"skin", 0}});
  EXPECT_EQ(touch(builder.write_glb(folder_ / "model.glb")).exit_code, 0);
}

TEST_F(Cost, OfPartsThatAllOverlap) {
  std::vector<geometry::SceneMesh> parts;
  for (int i = 0; i < 300; ++i) {
    Mesh ball = sphere(0.03, 5, 7);
    for (Vec3& p : ball.positions)
      p += 1e-4 * Vec3(std::sin(i), std::cos(3 * i), std::sin(7 * i));
    parts.push_back({"part", ball, {}, geometry::PartOf{"it", 0, 0}});
  }
  geometry::write_glb(folder_ / "model.glb", parts);
  expect_refused(touch(folder_ / "model.glb"), "its 300 convex parts overlap so much");
}

TEST_F(Cost, OfAModelTooLongForItsClusters) {
  const Result result = touch(box(Vec3(-127), Vec3(127)));
  expect_failure(result, 4, "model.glb: mesh \"it\" is 254 m long");
  expect_failure(result, 4, "give --finger-gap");
}

TEST_F(Cost, OfAMillionTriangles) {
  if (instrumented()) GTEST_SKIP() << "skipped: memory means nothing here";
  Mesh ball = sphere(0.05, 700, 700);
  for (Vec3& p : ball.positions)
    p *= 1 + 0.1 * std::sin(120 * p.x) * std::sin(130 * p.y);
  EXPECT_EQ(touch(ball).exit_code, 0);
}

}  // namespace
}  // namespace palpa::test
