// Contacts of solids made of convex parts, on both backends, against double precision over all parts and triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <string>

#include "base/error.hpp"
#include "geometry/parts/parts.hpp"
#include "support/thrown.hpp"
#include "touch/contacts/exact_contacts.hpp"
#include "touch/contacts/parts_table.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using geometry::InternalFaces;
using Clouds = std::vector<std::vector<Vec3>>;

geometry::Solid solid_of(const Clouds& clouds, InternalFaces faces, const std::string& name = "parts") {
  geometry::Solid solid;
  solid.name = name;
  solid.internal_faces = faces;
  for (const std::vector<Vec3>& cloud : clouds) {
    solid.parts.parts.push_back(geometry::make_part(cloud).value());
    solid.bounds.add(solid.parts.parts.back().bounds.low);
    solid.bounds.add(solid.parts.parts.back().bounds.high);
  }
  solid.parts.seam_m = geometry::smallest_seam(solid.parts.parts);
  return solid;
}

std::vector<Vec3> corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c)
    points.emplace_back(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z);
  return points;
}

std::vector<Vec3> ellipsoid(const Vec3& centre, const Vec3& half, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i)
    points.push_back(centre + half * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  return points;
}

/// Two cubes of 40 mm, 20 mm of which they share; top at y = 0.
geometry::Solid two_cubes(InternalFaces faces) {
  return solid_of({corners({-0.03, -0.04, -0.02}, {0.01, 0, 0.02}), corners({-0.01, -0.04, -0.02}, {0.03, 0, 0.02})},
                  faces, "two cubes");
}

/// Boxes of which the second overlaps the first, the third abuts the second, and the fourth abuts the first in a
/// corner.
geometry::Solid blocks(InternalFaces faces) {
  return solid_of({corners({0, 0, 0}, {0.04, 0.04, 0.04}), corners({0.02, 0, 0}, {0.06, 0.04, 0.04}),
                   corners({0.06, 0, 0}, {0.08, 0.02, 0.04}), corners({0, 0.04, 0}, {0.01, 0.05, 0.01})},
                  faces, "blocks");
}

/// A body, a head and an ear that overlap.
geometry::Solid animal(InternalFaces faces) {
  return solid_of({ellipsoid({0, 0, 0}, {0.03, 0.02, 0.02}, 1), ellipsoid({0.03, 0.015, 0}, {0.015, 0.015, 0.013}, 2),
                   ellipsoid({0.03, 0.035, 0.004}, {0.004, 0.015, 0.006}, 3)},
                  faces, "animal");
}

/// Hulls of random clouds, each reaching into some of the others, such as decompositions give.
geometry::Solid lump(std::size_t count, double size, unsigned seed, InternalFaces faces) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.3, 1);
  Clouds clouds(count);
  for (std::vector<Vec3>& cloud : clouds) {
    const Vec3 middle = 0.5 * size * Vec3(normal(random), normal(random), normal(random)) * 0.7;
    const Vec3 half = 0.5 * size * Vec3(unit(random), unit(random), unit(random)) * 0.6;
    for (int i = 0; i < 40; ++i)
      cloud.push_back(middle + half * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  }
  return solid_of(clouds, faces, "lump of " + std::to_string(count));
}

class PartsContacts : public OnBothBackends {};
INSTANTIATE_TEST_SUITE_P(, PartsContacts, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

TEST_P(PartsContacts, AreThoseBelowTheUnionsSurface) {
  for (const InternalFaces faces : {InternalFaces::drop, InternalFaces::keep}) {
    for (const geometry::Solid& solid : {blocks(faces), animal(faces), lump(24, 0.08, 24, faces)}) {
      SCOPED_TRACE(solid.name);
      const Vec3 margin = 0.1 * (solid.bounds.high - solid.bounds.low);
      const auto points = random_points(2000, solid.bounds.low - margin, solid.bounds.high + margin, 7);
      for (const double delta : {1.5e-3, 1.0}) {
        const Touch touch = touch_on(GetParam(), points, {solid}, {.delta_m = delta});
        EXPECT_GT(expect_contacts(touch, points, {solid}, delta), points.size() / 500);
      }
    }
  }
}

TEST_P(PartsContacts, AtACutAreNoneUnlessInternalFacesCount) {
  // A millimetre behind the second cube's left face, deep in the first; on the cut of the first; in the top's shell.
  const std::vector<glm::vec3> points{{-0.009F, -0.02F, 0}, {0.0095F, -0.02F, 0}, {0.0095F, -0.001F, 0}};
  const Touch drop = touch_on(GetParam(), points, {two_cubes(InternalFaces::drop)});
  ASSERT_EQ(drop.contacts.size(), 1u);
  EXPECT_EQ(drop.contacts[0].point, 2u);
  EXPECT_NEAR(drop.contacts[0].depth_m, 1e-3, 1e-7);
  const Touch keep = touch_on(GetParam(), points, {two_cubes(InternalFaces::keep)});
  ASSERT_EQ(keep.contacts.size(), 3u);
  EXPECT_NEAR(keep.contacts[0].depth_m, 1e-3, 1e-7);
  EXPECT_NEAR(keep.contacts[1].depth_m, 0.5e-3, 1e-7);
  EXPECT_NEAR(keep.contacts[2].depth_m, 0.5e-3, 1e-7);
  // Exactly on the cut of two boxes that abut, below the top and above it.
  const geometry::Solid halves =
      solid_of({corners({-0.02, 0, 0}, {0, 0.04, 0.04}), corners({0, 0, 0}, {0.02, 0.04, 0.04})}, InternalFaces::drop);
  const Touch cut = touch_on(GetParam(), {{0, 0.039F, 0.02F}, {0, 0.041F, 0.02F}}, {halves});
  ASSERT_EQ(cut.contacts.size(), 1u);
  EXPECT_NEAR(cut.contacts[0].depth_m, 1e-3, 1e-7);
}

TEST_P(PartsContacts, StandBesideOtherSolids) {
  geometry::Solid own_delta = animal(InternalFaces::drop);
  own_delta.haptics.delta_m = 3e-3;
  const std::vector<geometry::Solid> solids{two_cubes(InternalFaces::drop), own_delta, ball({0.03, 0.01, 0}, 0.02, 200),
                                            animal(InternalFaces::keep)};
  const auto points = random_points(4000, {-0.04, -0.045, -0.03}, {0.06, 0.06, 0.03}, 11);
  const Touch touch = touch_on(GetParam(), points, solids);
  expect_contacts(touch, points, solids, 1.5e-3);
  std::array<int, 4> of_solid{};
  for (const Contact& contact : touch.contacts)
    ++of_solid[contact.solid];
  EXPECT_GT(*std::min_element(of_solid.begin(), of_solid.begin() + 3), 10);
}

TEST_P(PartsContacts, GiveDeepPointsTheirDepth) {
  const geometry::Solid solid = animal(InternalFaces::drop);
  const auto points = random_points(2000, solid.bounds.low, solid.bounds.high, 5);
  const Touch touch = touch_on(GetParam(), points, {solid}, {.delta_m = 1.5e-3, .deep = true});
  EXPECT_GT(touch.deep.size(), 300u);
  const ExactDepth exact(solid);
  for (const Contact& deep : touch.deep) {
    ASSERT_NEAR(deep.depth_m, exact(Vec3(points[deep.point])), band);
    ASSERT_GE(deep.depth_m, 1.5e-3F);
  }
  const Touch without = touch_on(GetParam(), points, {solid}, {.delta_m = 1.5e-3});
  EXPECT_EQ(without.contacts.size(), touch.contacts.size());
}

TEST(PartsTwin, GivesTheSameBitsOnBoth) {
  const geometry::Solid solid = animal(InternalFaces::drop);
  const auto points = random_points(30'000, solid.bounds.low, solid.bounds.high, 9);
  for (const InternalFaces faces : {InternalFaces::drop, InternalFaces::keep}) {
    for (const bool deep : {false, true}) {
      const FingerOptions parameters{.delta_m = 2e-3, .deep = deep};
      expect_identical(touch_on(Backend::cpu, points, {animal(faces)}, parameters),
                       touch_on(Backend::gpu, points, {animal(faces)}, parameters));
    }
  }
}

TEST(PartsTable, ListsFewTrianglesWhereTheShellIs) {
  std::vector<shader::uvec4> words;
  const PartsGrid grid = add_parts(words, lump(40, 0.1, 9, InternalFaces::drop).parts, InternalFaces::drop);
  std::uint64_t listed = 0, cells = 0;
  for (std::uint32_t c = 0; c < grid.cells_per_axis * grid.cells_per_axis * grid.cells_per_axis; ++c) {
    const std::size_t at = grid.base + 1 + 2 * std::size_t{c};
    if (words[at].y == 0 || std::bit_cast<float>(words[at + 1].x) > 1.5e-3F) continue;
    listed += words[at].w;
    ++cells;
  }
  EXPECT_LT(static_cast<double>(listed) / static_cast<double>(cells), 60);
  EXPECT_LT(words.size() * sizeof(shader::uvec4), std::size_t{100} << 20);
}

TEST(PartsTable, RefusesPartsThatAreNone) {
  std::vector<shader::uvec4> words;
  EXPECT_ERROR(add_parts(words, {}, InternalFaces::drop), Exit::usage, "part has no planes");
  geometry::Parts broken = two_cubes(InternalFaces::drop).parts;
  broken.parts[1].planes[3].offset = std::nan("");
  EXPECT_ERROR(add_parts(words, broken, InternalFaces::drop), Exit::usage, "part has no planes");
}

}  // namespace
}  // namespace palpa::touch::test
