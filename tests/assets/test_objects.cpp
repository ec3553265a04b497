#include <numbers>

#include "assets/generators/objects.hpp"
#include "geometry/solid.hpp"
#include "shape_checks.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

constexpr double kHeight = 0.020 * (1 + std::numbers::sqrt2);  // 48.28 mm

void expect_box(const Mesh& mesh, const Vec3& low, const Vec3& high) {
  const Box box = geometry::bounds(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.low[axis], low[axis], 2e-9);
    EXPECT_NEAR(box.high[axis], high[axis], 2e-9);
  }
}

/// The paper's objects have the form that contacts require: one convex solid.
void expect_solid(const Mesh& mesh, std::size_t planes) {
  expect_sphere_like(mesh);
  EXPECT_LT(worst_concavity(mesh), 1e-9);
  const auto solids = geometry::make_solids({"test", {{"object", mesh}}});
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_EQ(solids[0].planes.size(), planes);
}

TEST(Cube, IsFourCentimetres) {
  const Mesh cube = make_cube();
  expect_solid(cube, 6);
  expect_box(cube, {-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  EXPECT_NEAR(geometry::signed_volume(cube), 64e-6, 1e-11);
}

TEST(Pyramid, Has45DegreesBetweenOppositeFaces) {
  const Mesh pyramid = make_pyramid();
  expect_solid(pyramid, 5);
  expect_box(pyramid, {-0.02, -kHeight, -0.02}, {0.02, 0, 0.02});
  EXPECT_NEAR(geometry::signed_volume(pyramid), 0.04 * 0.04 * kHeight / 3, 1e-11);
  int pairs = 0;
  for (const glm::uvec3& s : pyramid.triangles) {
    for (const glm::uvec3& t : pyramid.triangles) {
      const Vec3 n = unit_normal(pyramid, s), m = unit_normal(pyramid, t);
      // Opposite slopes are mirror images in the y axis. The faces enclose 180 degrees minus the angle of their
      // normals.
      if (n.y < 0 || glm::distance(n, Vec3(-m.x, m.y, -m.z)) > 1e-6) continue;
      EXPECT_NEAR(std::numbers::pi - std::acos(glm::dot(n, m)), std::numbers::pi / 4, 1e-6);
      ++pairs;
    }
  }
  EXPECT_EQ(pairs, 4);  // both pairs, in both orders
}

TEST(Prism, HasItsRidgeAlongZ) {
  const Mesh prism = make_prism();
  expect_solid(prism, 5);
  expect_box(prism, {-0.02, -kHeight, -0.02}, {0.02, 0, 0.02});
  EXPECT_NEAR(geometry::signed_volume(prism), 0.04 * 0.04 * kHeight / 2, 1e-11);
  int top = 0;
  for (const Vec3& p : prism.positions) {
    if (p.y < -1e-9) continue;
    EXPECT_EQ(p.x, 0.0);
    EXPECT_NEAR(std::fabs(p.z), 0.02, 1e-9);
    ++top;
  }
  EXPECT_EQ(top, 2);
}

class SemiSphere : public ::testing::Test {
 protected:
  const Mesh mesh_ = make_semi_sphere();
  static constexpr double kRadius = 0.02;
  const Vec3 centre_{0, -kRadius, 0};

  bool is_base(const glm::uvec3& t) const { return unit_normal(mesh_, t).y < -0.999; }
};

TEST_F(SemiSphere, IsClosedConvexAndOfItsSize) {
  std::size_t dome = 0;
  for (const glm::uvec3& t : mesh_.triangles)
    dome += is_base(t) ? 0 : 1;
  // No two of the dome's triangles share a plane: each is a plane of the solid, and the base is one more.
  expect_solid(mesh_, dome + 1);
  const Box box = geometry::bounds(mesh_);
  EXPECT_EQ(box.high.y, 0.0);
  EXPECT_NEAR(box.low.y, -kRadius, 1e-9);
  EXPECT_GE(mesh_.triangles.size(), 1500U);
  EXPECT_LE(mesh_.triangles.size(), 2500U);
  // Half a ball, minus the slivers between chords and sphere: at most 30 micrometres over the dome.
  const double ball = 2.0 / 3.0 * std::numbers::pi * kRadius * kRadius * kRadius;
  EXPECT_LT(geometry::signed_volume(mesh_), ball);
  EXPECT_GT(geometry::signed_volume(mesh_), ball - 30e-6 * 2 * std::numbers::pi * kRadius * kRadius);
}

TEST_F(SemiSphere, KeepsWithin30MicrometresOfTheSphere) {
  for (const Vec3& p : mesh_.positions)
    EXPECT_NEAR(glm::distance(p, centre_), kRadius, 3e-9);
  double deepest = 0.0;
  for (const glm::uvec3& t : mesh_.triangles) {
    if (is_base(t)) continue;
    // If the foot of the perpendicular from the centre lies inside the triangle, it is its deepest point.
    deepest = std::max(deepest, kRadius - glm::dot(unit_normal(mesh_, t), mesh_.positions[t.x] - centre_));
  }
  EXPECT_LT(deepest, 30e-6);
  EXPECT_GT(deepest, 10e-6);
}

TEST_F(SemiSphere, IsStrictlyConvexOnTheDome) {
  // Across every edge of the dome, the surface bends by a large part of the bend between two neighbours on a sphere.
  const std::vector<std::uint32_t> twin = geometry::twins(mesh_);
  double flattest = 1.0;
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    const glm::uvec3 &s = mesh_.triangles[side / 3], &t = mesh_.triangles[twin[side] / 3];
    if (is_base(s) || is_base(t)) continue;
    const Vec3& apex = mesh_.positions[geometry::opposite_vertex(mesh_, twin[side])];
    flattest = std::min(flattest, glm::dot(unit_normal(mesh_, s), mesh_.positions[s.x] - apex));
  }
  EXPECT_GT(flattest, 1e-7);  // metres below the neighbour's plane; a float's error here is 1e-9
}

}  // namespace
}  // namespace palpa::assets
