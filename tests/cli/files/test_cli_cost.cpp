// The cost of a file is bounded by its size. Families of models whose cost would grow faster than their size are
// processed, or rejected with the limit that they exceed, within processor time and memory that grow like their size.
// PALPA_EXHAUSTIVE tests large models near the limits; other runs test large models of at most a tenth of that size.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cli/support/boxes.hpp"
#include "cli/support/process.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/hostile_models.hpp"
#include "support/exhaustive.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

using geometry::Mesh;
using hostile::many_bones, hostile::needles, hostile::nested, hostile::rods;

class Cost : public testing::Test {
 protected:
  std::filesystem::path folder_ = scratch_folder("cost"), model_ = folder_ / "model.glb";
  /// Processor time in limits of docs/limits.md, which are of elapsed time on a quick machine: work that two cores
  /// share may take twice as much.
  double limits_ = 2 * slowest;

  Result touch_model() const {
    return within_limit({"touch", "--scene", model_, "--points", source_file("assets/finger.ply"), "--penetration",
                         "3mm", "--backend", "cpu"});
  }
  Result touch(const Mesh& mesh) const {
    write_model(mesh);
    return touch_model();
  }
  /// One frame of the mesh, as the paper's cameras see it.
  Result rendered(const Mesh& mesh) const {
    write_model(mesh);
    return within_limit({"run", "--scene", source_file("assets/cube.glb"), "--source", "synthetic:" + model_.string(),
                         "--frames", "1", "--every-frame", "--backend", "cpu"});
  }
  void write_model(const Mesh& mesh) const {
    const geometry::SceneMesh scene{"it", mesh};
    geometry::write_glb(model_, std::span(&scene, 1));
  }
  Result within_limit(const std::vector<std::string>& line) const {
    const Result result = palpa(line, {.environment = {{"PALPA_CACHE", "off"}}});
    const double megabytes = static_cast<double>(std::filesystem::file_size(model_)) / 1e6;
    // Elapsed time depends on other programs. Sanitizers need more time and memory.
    EXPECT_LT(result.processor_s, (instrumented() ? 45 : limits_) * (1 + megabytes)) << result.err;
    if (!instrumented()) {
      EXPECT_LT(result.peak_mib, 1e9 / (1 << 20)) << result.err;
    }
    return result;
  }
  static void expect_told(const Result& result, const std::string& part) {
    expect_failure(result, 4, "model.glb: mesh \"it\": ");
    expect_failure(result, 4, part);
  }
};

TEST_F(Cost, OfRodsSideBySide) {
  EXPECT_EQ(touch(rods(500)).exit_code, 0);
  expect_told(touch(rods(5000)), "pairs of its 60000 triangles have boxes that overlap");
}

TEST_F(Cost, OfShellsWithinShells) {
  constexpr int many = instrumented() ? 1001 : 4001;
  limits_ /= 2;
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
  builder.write_glb(model_);
  EXPECT_EQ(touch_model().exit_code, 0);
}

TEST_F(Cost, OfManyBones) {
  many_bones(5000).write_glb(model_);
  EXPECT_EQ(touch_model().exit_code, 0);
}

TEST_F(Cost, OfPartsThatAllOverlap) {
  std::vector<geometry::SceneMesh> parts;
  for (int i = 0; i < 300; ++i) {
    Mesh ball = sphere(0.03, 5, 7);
    for (Vec3& p : ball.positions)
      p += 1e-4 * Vec3(std::sin(i), std::cos(3 * i), std::sin(7 * i));
    parts.push_back({"part", ball, {}, geometry::PartOf{"it", 0, 0}});
  }
  geometry::write_glb(model_, parts);
  expect_told(touch_model(), "its 300 convex parts overlap so much");
}

TEST_F(Cost, OfAModelTooLongForItsClusters) {
  const Result result = touch(box(Vec3(-127), Vec3(127)));
  expect_failure(result, 4, "model.glb: mesh \"it\" is 254 m long");
  expect_failure(result, 4, "give --finger-gap");
}

TEST_F(Cost, OfAMillionTriangles) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer changes the use of memory";
  EXPECT_EQ(touch(bumpy_ball(exhaustive() ? 700 : 150)).exit_code, 0);
}

TEST_F(Cost, OfWhatASyntheticSourceRenders) {
  if (instrumented()) GTEST_SKIP() << "skipped: rays are too slow with a sanitizer";
  EXPECT_EQ(rendered(nested(exhaustive() ? 4001 : 401, true)).exit_code, 0);
  EXPECT_EQ(rendered(rods(exhaustive() ? 8000 : 800)).exit_code, 0);
  const auto expect_too_many = [&](std::uint32_t count) {
    expect_failure(rendered(needles(count)), 4, "model.glb: camera \"front left\" sees so many of its triangles");
  };
  expect_too_many(5000);
  if (exhaustive()) expect_too_many(50'000);
}

}  // namespace
}  // namespace palpa::test
