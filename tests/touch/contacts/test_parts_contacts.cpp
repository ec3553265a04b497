// Contacts of solids made of convex parts, on both backends, against double precision over all parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "geometry/parts/parts.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using geometry::InternalFaces;

/// Metres within which single precision may decide either way.
constexpr double band = 1e-6;

geometry::Solid solid_of(std::vector<std::vector<Vec3>> clouds, InternalFaces faces,
                         const std::string& name = "parts") {
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

/// A body, a head and an ear that overlap.
geometry::Solid animal(InternalFaces faces) {
  return solid_of({ellipsoid({0, 0, 0}, {0.03, 0.02, 0.02}, 1), ellipsoid({0.03, 0.015, 0}, {0.015, 0.015, 0.013}, 2),
                   ellipsoid({0.03, 0.035, 0.004}, {0.004, 0.015, 0.006}, 3)},
                  faces, "animal");
}

class PartsContacts : public OnBothBackends {};
INSTANTIATE_TEST_SUITE_P(, PartsContacts, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

/// Double precision over everything.
class Exact {
 public:
  explicit Exact(const geometry::Solid& solid) : solid_(&solid) {
    if (!solid.parts.parts.empty()) surface_ = geometry::union_surface(solid.parts);
  }
  double depth(const Vec3& p) const {
    const bool surface = !solid_->parts.parts.empty() && solid_->internal_faces == InternalFaces::drop;
    return surface ? geometry::depth(solid_->parts, surface_, p) : geometry::depth(*solid_, p);
  }

 private:
  const geometry::Solid* solid_;
  geometry::UnionSurface surface_;
};

/// Each point that double precision decides by more than the band is decided the same way.
void expect_contacts(const Touch& touch, const std::vector<glm::vec3>& points,
                     const std::vector<geometry::Solid>& solids, double delta) {
  std::vector<const Contact*> contact_of(points.size(), nullptr), deep_of = contact_of;
  for (const Contact& contact : touch.contacts)
    contact_of[contact.point] = &contact;
  for (const Contact& contact : touch.deep)
    deep_of[contact.point] = &contact;
  const std::vector<Exact> exact(solids.begin(), solids.end());
  std::size_t undecided = 0, contacts = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p(points[i]);
    bool close = false, in_shell = false;
    std::uint32_t solid = 0;
    double depth = 0;
    for (; solid < solids.size(); ++solid) {
      const double own = solids[solid].haptics.delta_m.value_or(delta);
      depth = exact[solid].depth(p);
      close = close || std::abs(depth - own) < band;
      for (const geometry::Part& part : solids[solid].parts.parts)
        close = close || std::abs(geometry::depth(part, p)) < band;
      in_shell = depth > 0 && depth < own;
      if (in_shell) break;
    }
    if (close) {
      ++undecided;
      continue;
    }
    ASSERT_EQ(contact_of[i] != nullptr, in_shell) << "point " << i << " depth " << depth;
    if (!in_shell) continue;
    ++contacts;
    EXPECT_EQ(contact_of[i]->solid, solid);
    ASSERT_NEAR(contact_of[i]->depth_m, depth, band);
  }
  EXPECT_GT(contacts, points.size() / 100);
  EXPECT_LE(undecided, points.size() / 100 + 10);
}

TEST_P(PartsContacts, AreThoseBelowTheUnionsSurface) {
  for (const InternalFaces faces : {InternalFaces::drop, InternalFaces::keep}) {
    for (const geometry::Solid& solid : {two_cubes(faces), animal(faces)}) {
      const Vec3 margin = 0.1 * (solid.bounds.high - solid.bounds.low);
      const auto points = random_points(2000, solid.bounds.low - margin, solid.bounds.high + margin, 7);
      for (const double delta : {1.5e-3, 6e-3, 1.0})
        expect_contacts(touch_on(GetParam(), points, {solid}, {.delta_m = delta}), points, {solid}, delta);
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
}

TEST_P(PartsContacts, StandBesideOtherSolids) {
  geometry::Solid own_delta = animal(InternalFaces::drop);
  own_delta.haptics.delta_m = 3e-3;
  const std::vector<geometry::Solid> solids{two_cubes(InternalFaces::drop), own_delta, ball({0.03, 0.01, 0}, 0.02, 200),
                                            animal(InternalFaces::keep)};
  const auto points = random_points(4000, {-0.04, -0.045, -0.03}, {0.06, 0.06, 0.03}, 11);
  const Touch touch = touch_on(GetParam(), points, solids);
  // The ball's depth is Eq. (1)'s.
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
  const Exact exact(solid);
  for (const Contact& deep : touch.deep) {
    const double depth = exact.depth(Vec3(points[deep.point]));
    ASSERT_NEAR(deep.depth_m, depth, 1e-6);
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
      const Parameters parameters{.delta_m = 2e-3, .deep = deep};
      expect_identical(touch_on(Backend::cpu, points, {animal(faces)}, parameters),
                       touch_on(Backend::gpu, points, {animal(faces)}, parameters));
    }
  }
}

}  // namespace
}  // namespace palpa::touch::test
