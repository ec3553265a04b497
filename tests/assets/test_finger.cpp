#include <array>
#include <numbers>

#include "assets/generators/finger.hpp"
#include "assets/generators/objects.hpp"
#include "assets/generators/shape.hpp"
#include "geometry/solid.hpp"
#include "shape_checks.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

class Finger : public ::testing::Test {
 protected:
  const Mesh mesh_ = make_finger();
};

TEST_F(Finger, HasThePapersSize) {
  expect_sphere_like(mesh_);
  EXPECT_EQ(mesh_.positions.size(), 2163U);
  EXPECT_EQ(mesh_.triangles.size(), 4322U);
  const Box box = geometry::bounds(mesh_);
  EXPECT_EQ(mesh_.positions[0], Vec3(0.0));
  EXPECT_EQ(box.low.y, 0.0);
  EXPECT_NEAR(box.high.y, 0.050, 1e-9);
  EXPECT_NEAR(box.high.x - box.low.x, 0.0185, 0.0005);
  EXPECT_NEAR((box.high.z - box.low.z) / (box.high.x - box.low.x), 0.9, 0.02);
}

TEST_F(Finger, HasATipOf8MillimetresRadius) {
  for (const Vec3& p : mesh_.positions) {
    if (p.y > 1e-3 || p.y == 0.0) continue;
    // The sphere through p that touches the plane y = 0 at the origin.
    EXPECT_NEAR(glm::dot(p, p) / (2 * p.y), 8e-3, 0.6e-3) << p.y;
  }
}

TEST_F(Finger, IsSmoothAndWellShaped) {
  EXPECT_GT(smallest_angle(mesh_), 35 * std::numbers::pi / 180);
  // No crease: neighbouring triangles bend at most as much as their size and the smallest radius of the ends require.
  const std::vector<std::uint32_t> twin = geometry::twins(mesh_);
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    const Vec3 n = unit_normal(mesh_, mesh_.triangles[side / 3]),
               m = unit_normal(mesh_, mesh_.triangles[twin[side] / 3]);
    EXPECT_LT(std::acos(std::min(1.0, glm::dot(n, m))), 0.5);
  }
}

TEST_F(Finger, IsFineAtTheTipAndCoarserOnTheShaft) {
  EXPECT_NEAR(mean_edge(mesh_, [](const Vec3& p) { return glm::length(p) < 2.5e-3; }), 0.5e-3, 0.04e-3);
  EXPECT_NEAR(mean_edge(mesh_, [](const Vec3& p) { return p.y > 0.02 && p.y < 0.042; }), 1.4e-3, 0.06e-3);
}

TEST_F(Finger, TouchesEachObjectWithEnoughVertices) {
  // Lowered by 3 mm over each object's top; contacts are vertices less than 1.5 mm deep, Eq. (1).
  struct Touch {
    const char* object;
    Mesh mesh;
    int contacts;
  };
  const std::array<Touch, 4> touches{{{"cube", make_cube(), 199},
                                      {"semi-sphere", make_semi_sphere(), 141},
                                      {"pyramid", make_pyramid(), 26},
                                      {"prism", make_prism(), 86}}};
  for (const Touch& touch : touches) {
    const geometry::Solid solid = geometry::make_solids({"test", {{touch.object, touch.mesh}}}).at(0);
    int contacts = 0;
    for (const Vec3& p : mesh_.positions) {
      const double depth = geometry::depth(solid, p - Vec3(0, 0.003, 0));
      if (depth > 0.0 && depth < 0.0015) ++contacts;
    }
    EXPECT_EQ(contacts, touch.contacts) << touch.object;
  }
}

}  // namespace
}  // namespace palpa::assets
