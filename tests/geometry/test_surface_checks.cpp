// The conditions for a mesh to become a solid, and the repairs: predicates, self-intersection, shells, needles,
// duplicates.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <random>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "geometry/mesh/mesh_repair.hpp"
#include "geometry/mesh/predicates.hpp"
#include "geometry/mesh/self_intersection.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/solid.hpp"
#include "geometry/surface/slabs.hpp"
#include "geometry/surface/surface.hpp"
#include "geometry/surface/surface_samples.hpp"
#include "geometry/surface/surface_triangles.hpp"
#include "hostile_models.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::box;

std::vector<Solid> checked_solids_of(const Mesh& mesh, SurfaceKind kind = SurfaceKind::mesh) {
  Scene scene{"test.glb", {}};
  scene.meshes.push_back({"thing", mesh});
  return make_solids(scene, kind);
}

std::string surface_fault_of(const Mesh& mesh) {
  return test::error_of([&] { checked_solids_of(mesh); });
}

TEST(Predicates, AreExactNearPlanes) {
  const Vec3 a(0.1, 0.2, 0.3), b(0.7, 0.1, 0.9), c(0.4, 0.8, 0.2);
  // A point of the plane up to rounding: one step of the last digit along an axis moves it to one side or the other.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 2);
  int up = 0, down = 0;
  for (int i = 0; i < 2000; ++i) {
    const double s = unit(random), t = unit(random);
    const Vec3 d = a + s * (b - a) + t * (c - a);
    const long double ux = static_cast<long double>(b.x) - a.x, uy = static_cast<long double>(b.y) - a.y,
                      uz = static_cast<long double>(b.z) - a.z, vx = static_cast<long double>(c.x) - a.x,
                      vy = static_cast<long double>(c.y) - a.y, vz = static_cast<long double>(c.z) - a.z,
                      wx = static_cast<long double>(d.x) - a.x, wy = static_cast<long double>(d.y) - a.y,
                      wz = static_cast<long double>(d.z) - a.z;
    const long double det = (ux * vy - uy * vx) * wz + (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy;
    const int sign = orient3d(a, b, c, d);
    if (std::abs(det) > 1e-18L) {
      EXPECT_EQ(sign, det > 0 ? 1 : -1) << s << " " << t;
    }
    EXPECT_EQ(orient3d(b, c, a, d), sign);
    EXPECT_EQ(orient3d(b, a, c, d), -sign);
    EXPECT_EQ(orient3d(a, b, d, c), -sign);
    up += sign > 0;
    down += sign < 0;
  }
  EXPECT_GT(up, 100);
  EXPECT_GT(down, 100);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 0}), 0);
  EXPECT_EQ(orient3d({1, 1, 1}, {2, 3, 4}, {3, 5, 7}, {9, 9, 1}), 0);  // three on a line
  EXPECT_EQ(orient2d({0, 0}, {1, 1}, {3, 3}), 0);
  EXPECT_EQ(orient2d({0.1, 0.1}, {0.3, 0.3}, {0.7, std::nextafter(0.7, 1.0)}), 1);
}

bool meet(const Vec3& a0, const Vec3& a1, const Vec3& a2, const Vec3& b0, const Vec3& b1, const Vec3& b2) {
  const Mesh mesh{{a0, a1, a2, b0, b1, b2}, {{0, 1, 2}, {3, 4, 5}}};
  const bool result = triangles_meet(mesh, 0, 1);
  EXPECT_EQ(triangles_meet(mesh, 1, 0), result);
  return result;
}

TEST(SelfIntersection, KnowsHowTwoTrianglesMeet) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  EXPECT_TRUE(meet(a, b, c, {0.5, 0.5, -1}, {0.5, 0.5, 1}, {3, 3, 1}));     // pierced
  EXPECT_FALSE(meet(a, b, c, {0.5, 0.5, 1}, {0.5, 0.6, 2}, {3, 3, 1}));     // above
  EXPECT_TRUE(meet(a, b, c, {0.5, 0.5, 0}, {0.5, 0.6, 2}, {3, 3, 1}));      // touched by a corner
  EXPECT_TRUE(meet(a, b, c, {1, 1, -1}, {1, 1, 1}, {3, 3, 1}));             // at its edge
  EXPECT_FALSE(meet(a, b, c, {1.001, 1, -1}, {1.001, 1, 1}, {3, 3, 1}));    // just beside it
  EXPECT_TRUE(meet(a, b, c, {0.1, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}));  // in its plane, inside
  EXPECT_TRUE(meet(a, b, c, {-1, -1, 0}, {5, -1, 0}, {-1, 5, 0}));          // in its plane, around
  EXPECT_TRUE(meet(a, b, c, {1, -1, 0}, {1, 1, 0}, {3, 0, 0}));             // in its plane, across
  EXPECT_FALSE(meet(a, b, c, {2, 2, 0}, {3, 2, 0}, {2, 3, 0}));             // in its plane, beside
  EXPECT_FALSE(meet(a, b, c, {-1, 1, 5e-16}, {3, 1, 5e-16}, {1, 1, 3}));    // just above
  EXPECT_TRUE(meet(a, b, c, {-1, 0.5, 0}, {3, 0.5, 0}, {1, 1, 3}));         // an edge in its plane
}

TEST(SelfIntersection, KnowsNeighboursThatFoldOver) {
  // Sharing the edge 0-1.
  const Mesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0.2, 0.5, 0}, {0.2, 0.5, 1e-15}},
                  {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}, {1, 0, 5}}};
  EXPECT_FALSE(triangles_meet(flat, 0, 1));
  EXPECT_TRUE(triangles_meet(flat, 0, 2));
  EXPECT_FALSE(triangles_meet(flat, 0, 3));
  // Sharing the vertex 0.
  const Mesh fan{{{0, 0, 0},
                  {1, 0, 0},
                  {0, 1, 0},
                  {-1, 0, 0},
                  {0, -1, 0},
                  {0.3, 0.3, 0},
                  {0.3, -1, 0},
                  {0.3, 0.3, -1},
                  {0.3, 0.3, 1}},
                 {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}, {0, 7, 8}}};
  EXPECT_FALSE(triangles_meet(fan, 0, 1));
  EXPECT_TRUE(triangles_meet(fan, 0, 2));
  EXPECT_TRUE(triangles_meet(fan, 0, 3));
}

TEST(SelfIntersection, AgreesWithTestingAllPairs) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  int with = 0, without = 0;
  for (int round = 0; round < 200; ++round) {
    Mesh soup;
    const int count = 2 + round % 30;
    for (int i = 0; i < count; ++i) {
      const Vec3 at = 3.0 * Vec3(unit(random), unit(random), unit(random));
      for (int k = 0; k < 3; ++k)
        soup.positions.push_back(at + Vec3(unit(random), unit(random), unit(random)));
      const auto first = static_cast<std::uint32_t>(3 * i);
      soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    bool any = false;
    for (std::uint32_t a = 0; a < soup.triangles.size(); ++a) {
      for (std::uint32_t b = a + 1; b < soup.triangles.size(); ++b)
        any = any || triangles_meet(soup, a, b);
    }
    const auto found = find_self_intersection(soup, Bvh(soup), 1'000'000);
    EXPECT_EQ(found.has_value(), any);
    if (found) {
      EXPECT_TRUE(triangles_meet(soup, found->triangles[0], found->triangles[1]));
    }
    ++(any ? with : without);
  }
  EXPECT_GT(with, 20);
  EXPECT_GT(without, 20);
}

TEST(SurfaceChecks, RefuseWhatPassesThroughItself) {
  Mesh dented = box(Vec3(0), Vec3(1));
  dented.positions[7] = Vec3(-0.4, 0.4, 0.4);  // through the opposite side
  const std::string line = surface_fault_of(dented);
  EXPECT_CONTAINS(line, "passes through or touches itself");
  EXPECT_CONTAINS(line, "triangles");
  EXPECT_CONTAINS(line, "--surface parts");
  EXPECT_NO_THROW(checked_solids_of(dented, SurfaceKind::parts));
  // Two bodies that overlap, and two that touch in a face but share no vertex of it.
  Mesh two = box(Vec3(0), Vec3(1));
  append(two, box(Vec3(0.5), Vec3(1.5)));
  EXPECT_CONTAINS(surface_fault_of(two), "touches itself");
  two = box(Vec3(0), Vec3(1));
  append(two, box(Vec3(1, 0.2, 0.2), Vec3(2, 0.8, 0.8)));
  EXPECT_CONTAINS(surface_fault_of(two), "touches itself");
}

TEST(SurfaceChecks, TurnOnlyWhatIsInsideOut) {
  Mesh mesh = box(Vec3(0), Vec3(1)), other = box(Vec3(3), Vec3(5)), cavity = box(Vec3(3.5), Vec3(4));
  flip(other);  // with its cavity facing outwards: the whole mesh is inside out
  append(other, cavity);
  append(mesh, other);
  std::vector<Solid> solids;
  const std::string warning = test::stderr_of([&] { solids = checked_solids_of(mesh); });
  EXPECT_CONTAINS(warning, "inside out in 2 of its 3 shells");
  EXPECT_NEAR(signed_volume(solids[0].mesh), 1 + 8 - 0.125, 1e-12);
  EXPECT_LT(depth(solids[0], Vec3(3.75)), 0);
  EXPECT_NEAR(depth(solids[0], Vec3(2)), -std::sqrt(3.0), 1e-12) << "between its bodies";
  EXPECT_TRUE(solids[0].planes.empty()) << "of several shells, none is convex";
  EXPECT_GT(depth(solids[0], Vec3(3.25)), 0);
}

TEST(SurfaceChecks, RefuseANestedShellThatFacesTheSameWay) {
  Mesh mesh = box(Vec3(0), Vec3(3));
  append(mesh, box(Vec3(1), Vec3(2)));
  const std::string line = surface_fault_of(mesh);
  EXPECT_CONTAINS(line, "a shell inside another that faces the same way");
  EXPECT_CONTAINS(line, "(1, 1, 1)");
  // A body inside a body's cavity is correct again.
  Mesh deep = box(Vec3(0), Vec3(9)), hole = box(Vec3(1), Vec3(8));
  flip(hole);
  append(deep, hole);
  append(deep, box(Vec3(2), Vec3(7)));
  EXPECT_NEAR(signed_volume(checked_solids_of(deep)[0].mesh), 729 - 343 + 125, 1e-9);
}

TEST(SurfaceChecks, LeaveDuplicatedFacesOut) {
  Mesh twice = box(Vec3(0), Vec3(1));
  append(twice, box(Vec3(0), Vec3(1)));
  std::vector<Solid> solids;
  EXPECT_CONTAINS(test::stderr_of([&] { solids = checked_solids_of(twice); }), "12 duplicated faces");
  EXPECT_EQ(solids[0].mesh.triangles.size(), 12U);
  Mesh one = box(Vec3(0), Vec3(1));
  one.triangles.push_back(one.triangles[3]);
  EXPECT_CONTAINS(test::stderr_of([&] { solids = checked_solids_of(one); }), "1 duplicated faces");
  EXPECT_EQ(solids[0].planes.size(), 6U);
  // Two boxes that share a side: there is no wall between them.
  Mesh walls = box(Vec3(0), Vec3(1)), next = box(Vec3(0), Vec3(1));
  for (Vec3& p : next.positions)
    p.x = 2 - p.x;  // mirrored, so that both sides are cut along the same diagonal
  flip(next);
  append(walls, next);
  EXPECT_CONTAINS(test::stderr_of([&] { solids = checked_solids_of(walls); }), "2 pairs of equal faces");
  EXPECT_NEAR(depth(solids[0], Vec3(1, 0.5, 0.5)), 0.5, 1e-12);
}

TEST(SurfaceChecks, RefuseAPieceWithoutVolume) {
  Mesh mesh = box(Vec3(0), Vec3(1));
  append(mesh, Mesh{{{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}});
  const std::string line = surface_fault_of(mesh);
  EXPECT_CONTAINS(line, "flat piece");
  EXPECT_CONTAINS(line, "(2, 0, 0)");
}

TEST(SurfaceChecks, TurnNeedles) {
  // A vertex exactly on an edge: a triangle without area between.
  Mesh cube = box(Vec3(0), Vec3(1));
  cube.positions.emplace_back(0.5, 0, 0);
  cube.triangles[0] = {0, 2, 8};
  cube.triangles.insert(cube.triangles.end(), {{8, 2, 1}, {0, 8, 1}});
  ASSERT_TRUE(find_defects(cube).closed_and_oriented());
  Mesh turned = cube;
  EXPECT_EQ(turn_needles(turned, 1e-7), 1U);
  ASSERT_TRUE(find_defects(turned).closed_and_oriented());
  for (std::uint32_t t = 0; t < turned.triangles.size(); ++t)
    EXPECT_GT(triangle_width(turned, t, glm::length(area_vector(turned, t))), 0.1);
  EXPECT_NEAR(signed_volume(turned), 1, 1e-12);
  EXPECT_EQ(surface_fault_of(cube), "");
  // Concave with a needle that rounding has folded over.
  Mesh dented = cube;
  dented.positions[7] = Vec3(0.4);
  dented.positions[8].y = -3e-9;
  EXPECT_EQ(surface_fault_of(dented), "");
}

TEST(Shells, KnowWhatIsAroundThem) {
  Mesh mesh = box(Vec3(0), Vec3(9));
  append(mesh, box(Vec3(1), Vec3(8)));
  append(mesh, box(Vec3(20), Vec3(21)));
  append(mesh, box(Vec3(2), Vec3(3)));
  Shells shells = find_shells(mesh, twins(mesh));
  ASSERT_EQ(shells.list.size(), 4U);
  find_nesting(mesh, Bvh(mesh), shells);
  const auto around = [&](std::uint32_t s) {
    return std::array{shells.list[s].depth, shells.list[s].parent, shells.list[s].outermost};
  };
  EXPECT_EQ(around(0), (std::array{0U, 0U, 0U}));
  EXPECT_EQ(around(1), (std::array{1U, 0U, 0U}));
  EXPECT_EQ(around(2), (std::array{0U, 2U, 2U}));
  EXPECT_EQ(around(3), (std::array{2U, 1U, 0U}));
  EXPECT_NEAR(shells.list[1].volume, 343, 1e-9);
}

TEST(Shells, AnyNumberInEachOther) {
  constexpr std::uint32_t count = 300;
  const Mesh mesh = test::hostile::nested(count, true);
  Shells shells = find_shells(mesh, twins(mesh));
  find_nesting(mesh, Bvh(mesh), shells);
  for (std::uint32_t i = 0; i < count; ++i) {
    EXPECT_EQ(shells.list[i].depth, count - 1 - i);
    EXPECT_EQ(shells.list[i].parent, std::min(i + 1, count - 1));
    EXPECT_EQ(shells.list[i].outermost, count - 1);
  }
}

TEST(Limits, PairsThatAreLookedAtAreCounted) {
  const Mesh mesh = test::hostile::rods(25);
  const Bvh bvh(mesh);
  EXPECT_FALSE(find_self_intersection(mesh, bvh, 300 * 300));
  EXPECT_CONTAINS(test::error_of([&] { find_self_intersection(mesh, bvh, 1000); }, Exit::failed),
                  "more than 1000 pairs of its 300 triangles");
  // Crossings that existed before are reported.
  Mesh crossing = mesh;
  append(crossing, test::transformed(mesh, [](const Vec3& p) { return p + Vec3(1e-3); }));
  EXPECT_TRUE(find_self_intersection(crossing, Bvh(crossing), 1'000'000));
}

TEST(Limits, StepsToASurfacesGridAreCounted) {
  const Mesh mesh = test::hostile::rods(144);
  EXPECT_FALSE(make_surface(mesh, {}).empty());
  EXPECT_CONTAINS(
      test::error_of([&] { make_surface(mesh, {.steps_per_cell = 250, .steps_per_triangle = 0, .spare_steps = 0}); },
                     Exit::failed),
      "turn the mesh so that its long faces run along an axis");
  // A mesh as modellers make them.
  EXPECT_FALSE(
      make_surface(test::torus(0.05, 0.02, 40), {.steps_per_cell = 250, .steps_per_triangle = 0, .spare_steps = 0})
          .empty());
}

/// Scales a ball's points: "shape" of unit directions.
template <typename Shape>
Mesh ball_of(int divisions, Shape shape) {
  Mesh ball = icosphere(1, divisions);
  for (Vec3& p : ball.positions)
    p = shape(p);
  return ball;
}

TEST(Limits, RoundThingsNeedFewSteps) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(1, 0.003);
  const SurfaceOptions deep{.deep = true, .steps_per_cell = 500, .steps_per_triangle = 0, .spare_steps = 0};
  EXPECT_FALSE(make_surface(ball_of(24, [](const Vec3& p) { return 0.03 * p; }), deep).empty());
  EXPECT_FALSE(make_surface(ball_of(24, [](const Vec3& p) { return 0.03 * p * Vec3(1, 1.3, 1); }), deep).empty());
  EXPECT_FALSE(make_surface(ball_of(24, [&](const Vec3& p) { return 0.03 * noise(random) * p; }), deep).empty());
  const auto long_and_waved = [](const Vec3& p) { return Vec3(0.02, 0.1, 0.02) * p * (1 + 0.05 * std::sin(30 * p.y)); };
  EXPECT_FALSE(make_surface(ball_of(24, long_and_waved), deep).empty());
}

TEST(Slabs, AreNearerThanTheirTrianglesAndSeldomMuch) {
  const Mesh mesh = ball_of(12, [](const Vec3& p) { return 0.03 * p * (1 + 0.05 * std::sin(9 * p.x)); });
  const Bvh bvh(mesh);
  const SurfaceTriangles triangles = make_surface_triangles(mesh, twins(mesh), bvh.order(), Vec3(0), 0);
  const std::vector<Slab> slabs = make_slabs(bvh.nodes(), triangles.triangles, 0);
  ASSERT_EQ(slabs.size(), bvh.nodes().size());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-0.04F, 0.04F);
  std::size_t tight = 0, tight_boxes = 0, asked = 0;
  for (std::size_t i = 0; i < slabs.size(); ++i) {
    const Bvh::Node& node = bvh.nodes()[i];
    for (int k = 0; k < 20; ++k) {
      const glm::vec3 p(place(random), place(random), place(random));
      double least = 1;
      for (std::uint32_t t = node.begin; t < node.end; ++t)
        least = std::min(least, glm::distance(nearest_point(triangles.triangles[t], Vec3(p)), Vec3(p)));
      EXPECT_LE(distance(slabs[i], p), least + 1e-8);
    }
    if (node.second != 0) continue;
    ++asked;
    double least = 1;
    for (std::uint32_t t = node.begin; t < node.end; ++t)
      least = std::min(least, glm::length(nearest_point(triangles.triangles[t], Vec3(0))));
    tight += distance(slabs[i], glm::vec3(0)) > 0.95 * least;
    tight_boxes += std::sqrt(distance2(node.box, Vec3(0))) > 0.95 * least;
  }
  EXPECT_GT(tight, asked * 9 / 10) << "seen from the middle";
  EXPECT_LT(tight_boxes, asked / 2) << "else slabs would be for nothing";
}

TEST(Surface, WithFewerCellsAnswersTheSame) {
  const Mesh mesh = test::ell();
  const Surface fine = make_surface(mesh, {}), coarse = make_surface(mesh, {.least_cells = 64});
  EXPECT_LT(coarse.cells.size() * 4, fine.cells.size());
  std::mt19937 random(4);
  std::uniform_real_distribution<float> anywhere(-0.04F, 0.04F);
  for (int i = 0; i < 20'000; ++i) {
    const glm::vec3 p(anywhere(random), anywhere(random), anywhere(random));
    if (glm::any(glm::lessThan(Vec3(p), fine.low)) || glm::any(glm::greaterThan(Vec3(p), fine.high))) continue;
    const Place a = find_place(fine, p, 1.5e-3F), b = find_place(coarse, p, 1.5e-3F);
    ASSERT_EQ(a.region, b.region);
    if (a.region != Region::shell) continue;
    ASSERT_EQ(a.depth_m, b.depth_m);
  }
}

TEST(Scenery, IsNoSolid) {
  Scene scene{"test.glb", {}};
  scene.meshes.push_back({"table", Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}});
  scene.meshes[0].haptics.touchable = false;
  EXPECT_CONTAINS(test::error_of([&] { make_solids(scene); }), "touchable");
  scene.meshes.push_back({"cube", box(Vec3(0), Vec3(1))});
  scene.meshes[1].haptics.delta_m = 2e-3;
  const auto solids = make_solids(scene);
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_EQ(solids[0].name, "cube");
  EXPECT_EQ(solids[0].haptics.delta_m, 2e-3);
}

}  // namespace
}  // namespace palpa::geometry
