// Decomposition: the parts that need no V-HACD always, the rest if palpa was built with it.
#include "geometry/parts/decompose.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "base/version.hpp"
#include "geometry/mesh/nearest.hpp"
#include "geometry/parts/vhacd.hpp"
#include "geometry/parts_solid.hpp"
#include "support/instrumented.hpp"
#include "support/own_cache.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

#define NEEDS_VHACD() \
  if (!built_with("V-HACD")) GTEST_SKIP() << "skipped: built without V-HACD"

TEST(Nearest, IsTheLeastOverAllTriangles) {
  const Mesh mesh = test::torus(0.05, 0.02, 24);
  const NearestTriangle nearest(mesh);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p(place(random), place(random), place(random));
    double least2 = 1e300;
    for (const glm::uvec3& t : mesh.triangles) {
      const Vec3 off = closest_on_triangle(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]], p) - p;
      least2 = std::min(least2, glm::dot(off, off));
    }
    const double found = nearest.distance(p);
    ASSERT_EQ(found, std::sqrt(least2)) << "the same bits";
    if (i >= 300) continue;
    // Independent of closest_on_triangle: the minimum over a fine grid of the triangles' points is an upper bound.
    double least = 1e300;
    for (const glm::uvec3& t : mesh.triangles) {
      const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
      for (int u = 0; u <= 8; ++u) {
        for (int v = 0; u + v <= 8; ++v)
          least = std::min(least, glm::distance(a + (b - a) * (u / 8.0) + (c - a) * (v / 8.0), p));
      }
    }
    ASSERT_LE(found, least + 1e-15);
    ASSERT_GE(found, least - 1e-3);
  }
}

// V-HACD's search tree has a level for each vertex of this mesh.
TEST(Vhacd, ItsStackHoldsALevelForEachVertex) {
  NEEDS_VHACD();
  if (test::instrumented()) GTEST_SKIP() << "skipped: what a level takes of the stack differs here";
  // Points on three sides of a cube, taken from each side in turn, so that each is the smallest along the axis that is
  // checked next.
  constexpr std::uint32_t side = 45;
  Mesh mesh;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double a = (i % side + 0.5) / side, b = (i / side + 0.5) / side;
    for (const Vec3& p : {Vec3(1, a, b), Vec3(a, 1, b), Vec3(a, b, 1)})
      mesh.positions.push_back(p);
    const auto last = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.triangles.emplace_back(last - 3, last - 2, last - 1);
  }
  append(mesh, test::box(Vec3(0), Vec3(1)));
  pthread_attr_t before, small;
  pthread_getattr_default_np(&before);
  pthread_attr_init(&small);
  pthread_attr_setstacksize(&small, std::size_t{256} << 10);
  pthread_setattr_default_np(&small);
  const auto hulls = vhacd_hulls(mesh, {.parts = 2, .resolution = 10'000, .error_percent = 50}, {});
  pthread_setattr_default_np(&before);
  pthread_attr_destroy(&small);
  pthread_attr_destroy(&before);
  EXPECT_FALSE(hulls.empty());
}

TEST(Decompose, LeavesAConvexMeshAsItIs) {
  for (const Mesh& mesh : {test::box({0, 0, 0}, {0.1, 0.2, 0.3}), test::sphere(0.05, 20, 40)}) {
    const Mesh stored = test::rounded(mesh);
    const auto parts = decompose(stored, {});
    ASSERT_TRUE(parts);
    ASSERT_EQ(parts->parts.size(), 1u);
    EXPECT_EQ(parts->parts[0].mesh.positions.size(), stored.positions.size());
    const PartsReport report = measure(stored, *parts, 0);
    EXPECT_NEAR(*report.volume_ratio(), 1, 1e-6);
    EXPECT_LT(report.surface_error_m.max, 1e-6);
    EXPECT_EQ(report.internal_share, 0);
  }
}

TEST(Decompose, SaysWhatCannotBeTakenApart) {
  EXPECT_CONTAINS(unfit_for_parts({}), "no triangle");
  EXPECT_CONTAINS(unfit_for_parts({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}), "flat");
  EXPECT_CONTAINS(unfit_for_parts(test::box({0, 0, 0}, {2e3, 1, 1})), "2000 m across");
  EXPECT_CONTAINS(unfit_for_parts(test::box(Vec3(0), Vec3(1e-8))), "1e-08 m across");
  EXPECT_EQ(unfit_for_parts(test::ell()), "");
}

TEST(Decompose, OfAnEllFindsItsNotch) {
  NEEDS_VHACD();
  const Mesh mesh = test::rounded(test::ell());
  const double whole = 0.06 * 0.04 * 0.04 * 0.75;
  ASSERT_NEAR(signed_volume(mesh), whole, 1e-9);
  double last = 0;
  int calls = 0;
  const auto parts = decompose(mesh, {.parts = 8, .resolution = 50'000}, [&](double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
    ++calls;
    return true;
  });
  ASSERT_TRUE(parts);
  EXPECT_GT(calls, 0);
  EXPECT_GT(parts->parts.size(), 1u);
  EXPECT_LE(parts->parts.size(), 8u);
  const PartsReport report = measure(mesh, *parts, 1);
  EXPECT_EQ(report.parts, parts->parts.size());
  EXPECT_NEAR(*report.volume_ratio(), 1, 0.05);
  EXPECT_LT(report.surface_error_m.mean, 5e-4);
  EXPECT_LT(report.surface_error_m.p95, 2e-3);
  EXPECT_GE(report.surface_error_m.p95, report.surface_error_m.mean);
  EXPECT_GE(report.surface_error_m.max, report.surface_error_m.p95);
  EXPECT_GT(report.internal_share, 0.05);
  EXPECT_LT(report.internal_share, 0.7);

  // The same bytes again, and with another seed nearly the same numbers.
  const auto again = decompose(mesh, {.parts = 8, .resolution = 50'000});
  ASSERT_EQ(again->parts.size(), parts->parts.size());
  for (std::size_t i = 0; i < parts->parts.size(); ++i)
    EXPECT_EQ(again->parts[i].mesh.positions, parts->parts[i].mesh.positions);
  EXPECT_EQ(measure(mesh, *again, 1).surface_error_m.mean, report.surface_error_m.mean);
  EXPECT_NE(measure(mesh, *again, 2).surface_error_m.mean, report.surface_error_m.mean);
  EXPECT_NEAR(measure(mesh, *again, 2).surface_error_m.mean, report.surface_error_m.mean,
              0.1 * report.surface_error_m.mean + 1e-6);
}

/// A cube of 40 mm whose walls have 2 mm.
Mesh hollow_cube() {
  Mesh mesh = test::box(Vec3(-0.02), Vec3(0.02)), cavity = test::box(Vec3(-0.018), Vec3(0.018));
  flip(cavity);
  append(mesh, cavity);
  return test::rounded(mesh);
}

TEST(Decompose, MeasuresBothWaysAndCountsFilledCavities) {
  const auto filled = decompose(test::rounded(test::box(Vec3(-0.02), Vec3(0.02))), {});
  const PartsReport report = measure(hollow_cube(), *filled, 0);
  EXPECT_LT(report.surface_error_m.max, 1e-8);
  EXPECT_NEAR(report.mesh_error_m.max, 0.002, 1e-6);
  EXPECT_NEAR(report.mesh_error_m.mean, 0.002 * 36 * 36 / (36 * 36 + 40 * 40), 1e-5);
  EXPECT_EQ(report.cavities, 1u);
  EXPECT_EQ(report.filled_cavities, 1u);
  EXPECT_CONTAINS(lost_cavities(report), "has 1 cavity inside; its parts fill 1");
  EXPECT_TRUE(has_cavities(hollow_cube()) && !has_cavities(test::ell()));
}

TEST(Decompose, KeepsACavity) {
  NEEDS_VHACD();
  const Mesh mesh = hollow_cube();
  const auto parts = decompose(mesh, {.resolution = 20'000});
  ASSERT_TRUE(parts);
  for (const Vec3& empty : {Vec3(0), Vec3(0.015), Vec3(-0.01, 0.016, 0.003)})
    EXPECT_EQ(depth(*parts, InternalFaces::drop, empty), 0);
  const PartsReport report = measure(mesh, *parts, 0);
  EXPECT_NEAR(*report.volume_ratio(), 1, 0.1);
  EXPECT_LT(report.mesh_error_m.mean, 1e-4);  // hulls round off the cavity's edges
  EXPECT_LT(report.mesh_error_m.p95, 1e-3);
  EXPECT_EQ(report.filled_cavities, 0u);
  EXPECT_EQ(lost_cavities(report), "");
}

TEST(Decompose, TakesOpenAndCrossingMeshes) {
  NEEDS_VHACD();
  // A torus with a hole in it, and one that passes through another.
  Mesh open = test::torus(0.05, 0.02, 24);
  const double whole = signed_volume(open);
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 6);
  const auto holed = decompose(weld(open), {.parts = 16, .resolution = 15'000});
  ASSERT_TRUE(holed);
  const PartsReport report = measure(weld(open), *holed, 0);
  EXPECT_NEAR(report.union_volume_m3 / whole, 1, 0.25);
  EXPECT_FALSE(report.mesh_volume_m3);

  Mesh crossing = test::torus(0.05, 0.02, 24);
  append(crossing, test::transformed(crossing, [](const Vec3& p) { return Vec3(p.x + 0.05, p.z, p.y); }));
  const auto crossed = decompose(crossing, {.parts = 32, .resolution = 15'000});
  ASSERT_TRUE(crossed);
  const double volume = measure(crossing, *crossed, 0).union_volume_m3;
  EXPECT_GT(volume, 1.5 * whole);
  EXPECT_LT(volume, 2.2 * whole);
}

// What is kept of a mesh is of its options.
TEST(UseParts, EachOptionHasItsOwnPartsAgain) {
  NEEDS_VHACD();
  const test::OwnCache cache(test::scratch_folder("kept-parts"));
  const Mesh mesh = test::rounded(test::ell());
  const DecomposeOptions usual{.parts = 8, .resolution = 10'000, .error_percent = 1};
  DecomposeOptions fewer = usual, finer = usual, rougher = usual;
  fewer.parts = 1;
  finer.resolution = 20'000;
  rougher.error_percent = 40;
  const auto corners_of = [](const Parts& parts) {
    std::vector<Vec3> corners;
    for (const Part& part : parts.parts)
      corners.insert(corners.end(), part.mesh.positions.begin(), part.mesh.positions.end());
    return corners;
  };
  std::vector<std::vector<Vec3>> fresh;
  for (const DecomposeOptions& options : {usual, fewer, finer, rougher}) {
    fresh.push_back(corners_of(*decompose(mesh, options)));
    EXPECT_EQ(fresh.back() == fresh[0], fresh.size() == 1) << fresh.size();
    for (const bool again : {false, true}) {
      Solid solid;
      solid.mesh = mesh;
      ASSERT_TRUE(use_parts(solid, options, {}));
      EXPECT_EQ(corners_of(solid.parts), fresh.back()) << fresh.size() << again;
    }
  }
}

TEST(Decompose, StopsWhenToldTo) {
  NEEDS_VHACD();
  int calls = 0;
  EXPECT_FALSE(decompose(test::torus(0.05, 0.02, 32), {.resolution = 100'000}, [&](double) { return ++calls < 2; }));
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace palpa::geometry
