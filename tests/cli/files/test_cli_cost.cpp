// The cost of a file is bounded by its size. Families of models whose cost would grow faster than their size are
// processed, or rejected with the limit that they exceed, within processor time and memory that grow like their size.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "cli/support/cost.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/hostile_models.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"

namespace palpa::test {
namespace {

using geometry::Mesh;
using hostile::many_bones, hostile::needles, hostile::nested, hostile::rods;

TEST_F(Cost, OfRodsSideBySide) {
  EXPECT_EQ(touch(rods(500)).exit_code, 0);
  expect_refused(touch(rods(5000)), "pairs of its 60000 triangles have boxes that overlap");
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
  EXPECT_EQ(touch(builder.write_glb(folder_ / "model.glb")).exit_code, 0);
}

TEST_F(Cost, OfManyBones) {
  EXPECT_EQ(touch(many_bones(5000).write_glb(folder_ / "model.glb")).exit_code, 0);
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

}  // namespace
}  // namespace palpa::test
