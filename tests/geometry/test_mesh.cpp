#include "geometry/mesh/mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "geometry/gltf/gltf.hpp"
#include "geometry/seeded_hash.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::geometry {
namespace {

using test::box;

TEST(Weld, SharesEqualPositionsAndKeepsOrderOfFirstUse) {
  const Mesh cube = test::unshared(box(Vec3(0), Vec3(1)));
  ASSERT_EQ(cube.positions.size(), 36U);
  const Mesh welded = weld(cube);
  EXPECT_EQ(welded.positions.size(), 8U);
  EXPECT_EQ(welded.triangles.size(), 12U);
  EXPECT_EQ(welded.triangles[0], glm::uvec3(0, 1, 2));
  EXPECT_EQ(welded.positions[1], cube.positions[1]);
  EXPECT_TRUE(find_defects(welded).closed_and_oriented());
}

TEST(Weld, TakesNegativeZeroForZero) {
  const Mesh mesh{{{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, 0}, {0, 1, -0.0}, {-1, 0, 0}},
                  {{0, 1, 2}, {3, 4, 5}}};
  const Mesh welded = weld(mesh);
  EXPECT_EQ(welded.positions.size(), 4U);
  for (const Vec3& p : welded.positions)
    EXPECT_FALSE(std::signbit(p.z));
}

TEST(Weld, DropsCollapsedTrianglesAndTheirVertices) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}, {9, 9, 9}, {8, 8, 8}, {7, 7, 7}},
                  {{3, 4, 5}, {0, 1, 2}}};
  const Mesh welded = weld(mesh);
  EXPECT_EQ(welded.triangles.size(), 1U);
  EXPECT_EQ(welded.positions.size(), 3U);
  EXPECT_TRUE(weld(Mesh{}).triangles.empty());
}

TEST(Weld, WithToleranceJoinsWhatRoundingParted) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-1e-9, 1e-9);
  for (const Vec3 shift : {Vec3(0), Vec3(-3, 5, 1e-9)}) {
    const Mesh mesh = test::transformed(test::unshared(test::sphere(0.02, 20, 30)), [&](const Vec3& p) {
      return p + shift + Vec3(jitter(random), jitter(random), jitter(random));
    });
    EXPECT_FALSE(find_defects(weld(mesh)).closed_and_oriented());
    const Mesh near = weld(mesh, 4e-9);
    EXPECT_EQ(near.positions.size(), 19U * 30 + 2);
    EXPECT_TRUE(find_defects(near).closed_and_oriented());
  }
}

TEST(Weld, WithToleranceSurvivesAbsurdCoordinates) {
  const double huge = 1e300;
  const Mesh mesh{{{huge, 0, 0}, {-huge, 0, 0}, {0, huge, 1e-300}}, {{0, 1, 2}}};
  EXPECT_EQ(weld(mesh, 1e-6).positions.size(), 3U);
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(weld(Mesh{{{inf, 0, 0}, {-inf, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, 1e-6).triangles.size(), 1U);
}

TEST(Mesh, VolumeAreaAndBounds) {
  const Mesh cube = box(Vec3(-1, 2, 3), Vec3(1, 5, 7));
  EXPECT_NEAR(signed_volume(cube), 24, 1e-12);
  EXPECT_NEAR(area(cube), 2 * (2 * 3 + 3 * 4 + 2 * 4), 1e-12);
  EXPECT_EQ(bounds(cube).low, Vec3(-1, 2, 3));
  EXPECT_EQ(bounds(cube).high, Vec3(1, 5, 7));
  EXPECT_NEAR(signed_volume(test::sphere(2, 200, 400)), 4.0 / 3 * std::numbers::pi * 8, 0.01);
  EXPECT_NEAR(area(test::sphere(2, 200, 400)), 4 * std::numbers::pi * 4, 0.01);
  EXPECT_TRUE(bounds(Mesh{}).empty());
  EXPECT_EQ(signed_volume(Mesh{}), 0);
}

TEST(Mesh, VolumeKeepsItsDigitsFarFromTheOrigin) {
  const Vec3 far(1e4, -2e4, 3e4);
  EXPECT_NEAR(signed_volume(box(far, far + Vec3(0.04))), 6.4e-5, 1e-12);
}

using Edge = std::array<std::uint32_t, 2>;

TEST(Defects, TheFirstOfEachKindIsNamed) {
  const Mesh cube = box(Vec3(0), Vec3(1));
  Mesh open = cube, turned = cube, two = cube;
  open.triangles.pop_back();
  // The first of the triangle (3, 7, 5)'s edges in ascending order is 3-5; it is open on the other triangle's side.
  EXPECT_EQ(find_defects(open).first_open, (Edge{3, 5}));
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  EXPECT_EQ(find_defects(turned).first_flipped, (Edge{0, 1}));
  append(two, box(Vec3(1, 1, 0), Vec3(2, 2, 1)));
  const Mesh welded = weld(two);
  for (const std::uint32_t v : find_defects(welded).first_non_manifold)
    EXPECT_EQ(Vec2(welded.positions[v]), Vec2(1));
  for (const Mesh& mesh : {open, turned, welded})
    EXPECT_FALSE(find_defects(mesh).closed_and_oriented());
}

TEST(Defects, AgreeWithACountOfPairsOnRandomTriangles) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Mesh mesh;
    const std::uint32_t vertices = 4 + random() % 5;
    for (std::uint32_t v = 0; v < vertices; ++v)
      mesh.positions.emplace_back(v, v * v, 1);
    for (int t = 0; t < 8; ++t) {
      const glm::uvec3 c(random() % vertices, random() % vertices, random() % vertices);
      if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) mesh.triangles.push_back(c);
    }
    std::uint64_t open = 0, many = 0, flipped = 0;
    for (std::uint32_t a = 0; a < vertices; ++a) {
      for (std::uint32_t b = a + 1; b < vertices; ++b) {
        int forward = 0, backward = 0;
        for (const glm::uvec3& t : mesh.triangles) {
          for (int i = 0; i < 3; ++i) {
            forward += t[i] == a && t[(i + 1) % 3] == b ? 1 : 0;
            backward += t[i] == b && t[(i + 1) % 3] == a ? 1 : 0;
          }
        }
        open += forward + backward == 1 ? 1 : 0;
        many += forward + backward > 2 ? 1 : 0;
        flipped += forward + backward == 2 && forward != 1 ? 1 : 0;
      }
    }
    const Defects d = find_defects(mesh);
    EXPECT_EQ(d.open, open);
    EXPECT_EQ(d.non_manifold, many);
    EXPECT_EQ(d.flipped, flipped);
  }
}

// Adding many pieces one by one must not copy everything each time.
TEST(Append, MakesRoomAheadOfTime) {
  Mesh all;
  const Mesh piece = test::box(Vec3(0), Vec3(1));
  int moves = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::size_t before = all.triangles.capacity();
    append(all, piece);
    if (all.triangles.capacity() != before) ++moves;
  }
  EXPECT_EQ(all.triangles.size(), 60'000U);
  EXPECT_LT(moves, 40);
}

// Positions for which a weaker hash has few buckets.
TEST(Weld, PositionsThatAreMadeToCollideDoNot) {
  PALPA_SHARED_OR_SKIP(folder, "hostile");
  const Scene scene = load_gltf(folder / "hashflood_100k.glb");
  const std::vector<Vec3>& positions = scene.meshes.at(0).mesh.positions;
  std::vector<bool> taken(1U << 18U);
  std::size_t buckets = 0;
  for (const Vec3& p : positions) {
    std::uint64_t h = hash_seed();
    for (int i = 0; i < 3; ++i)
      h = mix_hash(h, std::bit_cast<std::uint64_t>(p[i]));
    const std::size_t bucket = h % taken.size();
    if (!taken[bucket]) ++buckets;
    taken[bucket] = true;
  }
  // As many buckets as for random numbers: 1 - exp(-n / 2^18) of 2^18.
  const double n = static_cast<double>(positions.size()), m = static_cast<double>(taken.size());
  EXPECT_GT(static_cast<double>(buckets), 0.95 * m * (1 - std::exp(-n / m)));
}

}  // namespace
}  // namespace palpa::geometry
