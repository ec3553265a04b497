#include "geometry/solid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>
#include <utility>

#include "geometry/mesh/topology.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::error_of;

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene{"test.glb", {}};
  for (std::size_t i = 0; i < meshes.size(); ++i)
    scene.meshes.push_back({"mesh " + std::to_string(i), std::move(meshes[i])});
  return scene;
}

std::vector<Solid> solids_of(std::vector<Mesh> meshes) {
  return make_solids(scene_of(std::move(meshes)));
}

std::string solid_fault_of(std::vector<Mesh> meshes) {
  std::string line = error_of([&] { solids_of(std::move(meshes)); });
  EXPECT_TRUE(line.empty() || line.starts_with("test.glb: ")) << line;
  return line;
}

/// A mesh that is accepted as a solid, but not as a convex one.
bool is_concave(const Mesh& mesh) {
  return solids_of({mesh})[0].planes.empty();
}

glm::dmat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::mat3_cast(glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
}

TEST(Solid, CubeHasSixPlanesAndExactDepth) {
  const auto solids = solids_of({test::unshared(box(Vec3(-0.02, -0.04, -0.02), Vec3(0.02, 0, 0.02)))});
  ASSERT_EQ(solids.size(), 1U);
  const Solid& cube = solids[0];
  EXPECT_EQ(cube.name, "mesh 0");
  EXPECT_EQ(cube.mesh.positions.size(), 8U);
  ASSERT_EQ(cube.planes.size(), 6U);
  for (const Plane& p : cube.planes)
    EXPECT_NEAR(glm::length(p.normal), 1, 1e-15);
  EXPECT_EQ(cube.bounds.low, Vec3(-0.02, -0.04, -0.02));
  EXPECT_NEAR(depth(cube, Vec3(0, -0.02, 0)), 0.02, 1e-15);
  EXPECT_NEAR(depth(cube, Vec3(0.019, -0.02, 0)), 0.001, 1e-15);
  EXPECT_NEAR(depth(cube, Vec3(0, 0.003, 0)), -0.003, 1e-15);
  EXPECT_NEAR(depth(cube, Vec3(0.024, 0.003, 0)), -0.004, 1e-15);
}

TEST(Solid, DepthIsTheDistanceToTheSurfaceInside) {
  const Solid ball = solids_of({test::rounded(test::sphere(0.02, 40, 60))})[0];
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p(uniform(random), uniform(random), uniform(random));
    // Faces lie between the sphere and their sagitta below it.
    EXPECT_LE(depth(ball, p), 0.02 - glm::length(p) + 1e-9);
    EXPECT_GE(depth(ball, p), 0.02 - glm::length(p) - 5e-5);
  }
}

TEST(Solid, MergesCoplanarTrianglesOfFinelyDividedFaces) {
  // Each face of a turned cube as 20 x 20 squares, in single precision.
  std::mt19937 random(9);
  for (int round = 0; round < 10; ++round) {
    const glm::dmat3 R = random_rotation(random);
    const Mesh mesh = test::transformed(test::unshared(test::squared_cube(0.04, 20)),
                                        [&](const Vec3& p) { return R * p + Vec3(0.05, 0, 0); });
    const Solid cube = solids_of({test::rounded(mesh)})[0];
    EXPECT_EQ(cube.planes.size(), 6U);
    EXPECT_NEAR(depth(cube, Vec3(0.05, 0, 0)), 0.02, 2e-8);
  }
}

TEST(Solid, OpenMeshesThatCloseTogetherAreOneSolid) {
  // Two boxes, each split over two nodes, interleaved, and one whole one.
  std::vector<Mesh> pieces;
  for (const Vec3 at : {Vec3(0), Vec3(5, 0, 0)}) {
    const Mesh whole = box(at, at + Vec3(1));
    Mesh top{whole.positions, {whole.triangles.begin(), whole.triangles.begin() + 5}};
    Mesh rest{whole.positions, {whole.triangles.begin() + 5, whole.triangles.end()}};
    pieces.push_back(top);
    pieces.push_back(rest);
  }
  std::swap(pieces[1], pieces[2]);
  pieces.push_back(box(Vec3(9), Vec3(10)));
  const auto solids = solids_of(pieces);
  ASSERT_EQ(solids.size(), 3U);
  EXPECT_EQ(solids[0].name, "mesh 0");
  EXPECT_EQ(solids[1].name, "mesh 1");
  EXPECT_EQ(solids[2].name, "mesh 4");
  for (const Solid& s : solids)
    EXPECT_NEAR(signed_volume(s.mesh), 1, 1e-12);
}

TEST(Solid, SeamsThatWereRoundedDifferentlyClose) {
  Mesh mesh = test::unshared(test::sphere(0.02, 10, 16));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-2e-9, 2e-9);
  for (Vec3& p : mesh.positions)
    p += Vec3(jitter(random), jitter(random), jitter(random));
  EXPECT_EQ(solids_of({mesh})[0].mesh.positions.size(), 9U * 16 + 2);
}

TEST(Solid, MeshesThatAreNoSolidAreRefusedWithTheirFault) {
  const Mesh cube = box(Vec3(0), Vec3(0.04)), sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  Mesh open = cube, turned = cube, touching = box(Vec3(0), Vec3(1));
  open.triangles.pop_back();
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  append(touching, box(Vec3(1, 1, 0), Vec3(2, 2, 1)));
  EXPECT_CONTAINS(solid_fault_of({}), "no triangle mesh");
  const std::vector<std::pair<Mesh, const char*>> meshes{
      {open, "mesh \"mesh 0\""},
      {open, "3 open edges (the first runs from"},
      {open, "(0.04, 0.04, 0)"},
      {turned, "3 edges lie between faces of opposite orientation"},
      {touching, "1 edge has more than two faces (it runs from"},
      {sheet, "flat"},
      {box(Vec3(0), Vec3(1, 1, 1e-9)), "flat"},
      {Mesh{{{1, 2, 3}}, {{0, 0, 0}}}, "flat"},
      {box(Vec3(0), Vec3(1e30)), "kilometre"},
      {box(Vec3(1e9), Vec3(1e9 + 1)), "kilometre"},
      {box(Vec3(0), Vec3(1e-9)), "micrometre"},
  };
  for (const auto& [mesh, message] : meshes)
    EXPECT_CONTAINS(solid_fault_of({mesh}), message);
  // A sheet of paper is accepted as a solid.
  EXPECT_EQ(solids_of({box(Vec3(0), Vec3(0.2, 0.3, 1e-4))})[0].planes.size(), 6U);
}

TEST(Convexity, NamesTheReflexEdgeAndItsAngle) {
  // A house with its roof pushed in by 45 degrees: the valley runs along z at x = 0.5, y = 1.
  const Mesh house =
      test::prism({{0, 0}, {1, 0}, {1, 1.5}, {0.5, 1}, {0, 1.5}}, {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}}, 0, 2);
  ASSERT_TRUE(find_defects(house).closed_and_oriented());
  const std::vector<std::uint32_t> twin = twins(house);
  const double tolerance = flatness_tolerance(house);
  const auto reflex = find_concavity(house, twin, find_facets(house, twin, tolerance), tolerance);
  ASSERT_TRUE(reflex.has_value());
  EXPECT_NEAR(reflex->angle, std::numbers::pi / 2, 1e-12);
  for (const std::uint32_t v : reflex->vertices) {
    EXPECT_EQ(house.positions[v].x, 0.5);
    EXPECT_EQ(house.positions[v].y, 1);
  }
  EXPECT_TRUE(is_concave(house));
  EXPECT_TRUE(is_concave(test::torus(0.03, 0.01, 24)));
}

TEST(Convexity, AcceptsConvexBodiesInSinglePrecisionAnywhere) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> scale(0.2, 3);
  for (int round = 0; round < 60; ++round) {
    const glm::dmat3 R = random_rotation(random);
    const Vec3 stretch(scale(random), scale(random), scale(random)), at(0.1 * (round % 7), -0.3, 0.05 * round);
    const int rings = 3 + static_cast<int>(random() % 40), segments = 3 + static_cast<int>(random() % 80);
    const Mesh mesh =
        test::transformed(test::sphere(0.02, rings, segments), [&](const Vec3& p) { return R * (stretch * p) + at; });
    EXPECT_FALSE(is_concave(test::rounded(mesh))) << rings << " x " << segments;
  }
}

TEST(Convexity, FindsAVertexPushedIn) {
  std::mt19937 random(13);
  for (int round = 0; round < 60; ++round) {
    Mesh mesh = test::sphere(0.02, 10 + round % 5, 14);
    // Beyond the chord of its neighbours: the sagitta of a 26 degree cap is 2.5 % of the radius.
    mesh.positions[random() % mesh.positions.size()] *= 0.94;
    EXPECT_TRUE(is_concave(mesh));
  }
}

TEST(Convexity, AcceptsSliversButNotWhatTheyHide) {
  // A cube whose face has a vertex almost on an edge: the triangle between is a needle without a direction.
  Mesh cube = box(Vec3(0), Vec3(1));
  cube.positions.emplace_back(0.5, 1e-9, 0);
  // The edge 0-1 at y = z = 0, shared by (0,2,1) and (0,1,4), is cut: the vertex belongs to the face z = 0.
  cube.triangles[0] = {0, 2, 8};
  cube.triangles.insert(cube.triangles.end(), {{8, 2, 1}, {0, 8, 1}});
  ASSERT_TRUE(find_defects(cube).closed_and_oriented());
  const auto solids = solids_of({cube});
  EXPECT_EQ(solids[0].planes.size(), 6U);
  EXPECT_NEAR(depth(solids[0], Vec3(0.5)), 0.5, 1e-6);
  // An L-shape whose inner corner is bevelled by a strip too narrow to have a normal.
  const double w = 2e-7;
  const Mesh bevelled = test::prism({{0, 0}, {2, 0}, {2, 1}, {1 + w, 1}, {1, 1 + w}, {1, 2}, {0, 2}},
                                    {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {0, 4, 6}, {4, 5, 6}}, 0, 1);
  ASSERT_TRUE(find_defects(bevelled).closed_and_oriented());
  EXPECT_TRUE(is_concave(bevelled));
}

// A dent so shallow and so finely divided that none of its edges exceeds rounding.
TEST(Convexity, FindsADentOfEdgesTooFlatToCall) {
  const Mesh fine = test::transformed(test::sphere(0.02, 400, 800), [](const Vec3& p) {
    // The polar cap, radius 6 mm, is bent inwards to a bowl of the same curvature: about 1.9 mm deep.
    const double limit = 0.019;
    return p.z > limit ? Vec3(p.x, p.y, 2 * limit - p.z) : p;
  });
  EXPECT_TRUE(is_concave(test::rounded(fine)));
  // The same bowl, 4 micrometres deep.
  const Mesh shallow = test::transformed(test::sphere(0.02, 400, 800), [](const Vec3& p) {
    const double r = std::hypot(p.x, p.y), z = 0.0199 + r * r;
    return p.z > z ? Vec3(p.x, p.y, z) : p;
  });
  EXPECT_TRUE(is_concave(test::rounded(shallow)));
}

TEST(Convexity, AMillionFacesTakeSeconds) {
  const Mesh mesh = test::rounded(test::sphere(0.02, 500, 1000));
  ASSERT_EQ(mesh.triangles.size(), 998'000U);
  [[maybe_unused]] const double start = test::processor_s();
  const auto solids = solids_of({mesh});
  [[maybe_unused]] const double spent = test::processor_s() - start;
  EXPECT_NEAR(signed_volume(solids[0].mesh), 4.0 / 3 * std::numbers::pi * 8e-6, 1e-9);
#ifdef NDEBUG
  EXPECT_LT(spent, 10 * test::slowest);
#endif
}

}  // namespace
}  // namespace palpa::geometry
