// Eq. (1) on both backends against double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "support/device.hpp"
#include "support/exhaustive.hpp"
#include "support/thrown.hpp"
#include "touch/contacts/contacts_pass.hpp"
#include "touch/contacts/exact_contacts.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

class Contacts : public OnBothBackends {};
INSTANTIATE_TEST_SUITE_P(, Contacts, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

TEST_P(Contacts, AgreeWithDoublePrecision) {
  for (const geometry::Solid& solid : {cube(), half_ball({0, -0.02, 0}, 0.02, 1000), ball({0, -0.01, 0}, 0.015, 40),
                                       ball({0.4, 0.1, -0.3}, 0.25, 3000), half_ball({0.3, -0.2, 0.9}, 0.4, 200)}) {
    const Vec3 margin = 0.1 * (solid.bounds.high - solid.bounds.low);
    const auto points = random_points(5000, solid.bounds.low - margin, solid.bounds.high + margin, 7);
    for (const double delta : {1.5e-3, 6e-3, 10.0})
      expect_contacts(touch_on(GetParam(), points, {solid}, {.delta_m = delta}), points, {solid}, delta);
  }
}

TEST_P(Contacts, ManyPlanesCostNothingInCorrectness) {
  const geometry::Solid solid = ball({0, 0, 0}, 0.05, 50'000);
  const auto points = random_points(3000, Vec3(-0.051), Vec3(0.051));
  EXPECT_GT(expect_contacts(touch_on(GetParam(), points, {solid}), points, {solid}, 1.5e-3), 50u);
}

TEST_P(Contacts, OfSeveralSolidsBelongToTheFirst) {
  const std::vector<geometry::Solid> solids{ball({0, 0, 0}, 0.02, 300, "first"),
                                            box({-0.01, -0.03, -0.01}, {0.03, 0.01, 0.01}),
                                            ball({0.02, 0, 0}, 0.02, 20, "third")};
  const auto points = random_points(20'000, Vec3(-0.03), Vec3(0.045));
  const Touch touch = touch_on(GetParam(), points, solids, {.delta_m = 4e-3});
  expect_contacts(touch, points, solids, 4e-3);
  std::array<int, 3> of_solid{};
  for (const Contact& contact : touch.contacts)
    ++of_solid[contact.solid];
  EXPECT_GT(*std::min_element(of_solid.begin(), of_solid.end()), 100);
}

TEST_P(Contacts, TheBoundaryBelongsToNeitherSide) {
  // A box whose faces single precision holds exactly, its centre at the origin.
  const geometry::Solid solid = box(Vec3(-0.5), Vec3(0.5));
  const float delta = 0.125F, edge = 0.5F, inner = 0.375F;
  const float below = std::nextafter(edge, 0.0F), beyond = std::nextafter(inner, 0.0F),
              within = std::nextafter(inner, 1.0F);
  const std::vector<glm::vec3> points{{0, edge, 0},   {0, below, 0},   {0, inner, 0},     {0, within, 0},
                                      {0, beyond, 0}, {edge, edge, 0}, {-edge, 0, 0},     {-below, 0, 0},
                                      {0, 0, -inner}, {0, 0, -within}, {below, below, 0}, {inner, inner, 0}};
  const Touch touch = touch_on(GetParam(), points, {solid}, {.delta_m = delta});
  std::vector<std::uint32_t> found;
  for (const Contact& contact : touch.contacts)
    found.push_back(contact.point);
  EXPECT_EQ(found, (std::vector<std::uint32_t>{1, 3, 7, 9, 10}));
}

TEST_P(Contacts, OfNoPointsOrNoSolidsAreNone) {
  EXPECT_TRUE(touch_on(GetParam(), {}, {cube()}).contacts.empty());
  EXPECT_TRUE(touch_on(GetParam(), {{0, -1e-3, 0}}, {}).contacts.empty());
  const Touch one = touch_on(GetParam(), {{0, -1e-3, 0}}, {cube()});
  ASSERT_EQ(one.contacts.size(), 1u);
  EXPECT_NEAR(one.contacts[0].depth_m, 1e-3, 1e-8);
  EXPECT_EQ(one.finger_count, 0u);
}

TEST_P(Contacts, AreNeverPointsThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const float huge = std::numeric_limits<float>::max();
  const std::vector<glm::vec3> points{{nan, -1e-3F, 0}, {0, nan, 0},       {0, -1e-3F, nan},  {inf, -1e-3F, 0},
                                      {0, -inf, 0},     {0, -1e-3F, inf},  {huge, -1e-3F, 0}, {0, -huge, 0},
                                      {0, -1e-3F, 0},   {-huge, huge, nan}};
  const Touch touch = touch_on(GetParam(), points, {cube()});
  ASSERT_EQ(touch.contacts.size(), 1u);
  EXPECT_EQ(touch.contacts[0].point, 8u);
  const Touch thick = touch_on(GetParam(), points, {everything()}, everything_is_contact());
  EXPECT_EQ(thick.contacts.size(), 1u);
}

TEST_P(Contacts, ComeOutInInputOrderWhateverTheCount) {
  for (const std::uint32_t count : {1U, 31U, 32U, 63U, 64U, 65U, 4095U, 4096U, 4097U, 8193U, 70'001U}) {
    const auto points = random_points(count, Vec3(-0.5), Vec3(0.5), count);
    const Touch touch = touch_on(GetParam(), points, {everything()}, everything_is_contact(5e-4));
    ASSERT_EQ(touch.contacts.size(), count);
    for (std::uint32_t i = 0; i < count; ++i)
      ASSERT_EQ(touch.contacts[i].point, i);
  }
}

TEST_P(Contacts, OfManySmallSolidsAreAllThere) {
  // More boxes for a thread's points than a software device has turns for in one chunk.
  std::vector<geometry::Solid> dots;
  dots.reserve(4096);
  for (int i = 0; i < 38 * 38; ++i) {
    const Vec3 at(0.01 * (i % 38), 0.01 * static_cast<int>(i / 38), 0);
    dots.push_back(box(at, at + Vec3(2e-3), "dot"));
  }
  const std::uint32_t count = GetParam() == Backend::cpu ? palpa::test::samples(20'000, 100'000) : 100'000;
  const auto points = random_points(count, Vec3(0, 0, 0), Vec3(0.38, 0.38, 2e-3));
  const double delta = 0.5e-3;
  const Touch touch = touch_on(GetParam(), points, dots, {.delta_m = delta, .finger_gap_m = 2e-3}, 1);
  std::size_t expected = 0, close = 0;
  for (const glm::vec3& p : points) {
    const auto column = static_cast<std::size_t>(p.x / 0.01), row = static_cast<std::size_t>(p.y / 0.01);
    const double depth =
        ExactDepth(dots[std::min<std::size_t>(row, 37) * 38 + std::min<std::size_t>(column, 37)])(Vec3(p));
    expected += depth > 0 && depth < delta ? 1 : 0;
    close += std::abs(depth) < band || std::abs(depth - delta) < band ? 1 : 0;
  }
  EXPECT_GT(expected, count / 100);
  EXPECT_NEAR(static_cast<double>(touch.contacts.size()), static_cast<double>(expected), static_cast<double>(close));
}

TEST_P(Contacts, DeepInABallOfManyPlanesAreAllThere) {
  // Deep cells list every plane of the ball: more looks for a thread's points than a software device has turns for.
  const std::uint32_t count = GetParam() == Backend::cpu ? palpa::test::samples(10'000, 70'000) : 70'000;
  const auto points = random_points(count, Vec3(-0.04), Vec3(0.04));
  const Touch touch = touch_on(GetParam(), points, {ball({0, 0, 0}, 0.1, 4096)},
                               {.finger_gap_m = 5e-3, .cluster = Cluster::inside, .deep = true}, 1);
  EXPECT_EQ(touch.deep.size(), points.size());
}

TEST(PreparedSolids, RefusesMoreThanADeviceThatCountsTurnsCanLookAt) {
  if (!palpa::test::test_device().description().ends_long_loops) GTEST_SKIP() << "this device counts no turns";
  const std::vector<geometry::Solid> solids(30'001, cube());
  const std::vector<glm::vec3> points{{0, -1e-3, 0}};
  const Error many_solids = palpa::test::thrown_by([&] { touch_on(Backend::gpu, points, solids, {}); });
  EXPECT_CONTAINS(many_solids.what(), "30001 solids can take");
  EXPECT_CONTAINS(many_solids.what(), "--backend cpu");
  EXPECT_EQ(touch_on(Backend::cpu, points, solids, {}).contacts.size(), 1U);
  // Solids of a file are the file's fault.
  PreparedSolids many;
  many.file = "many.glb";
  many.records.resize(20'000);
  many.iterations = 70'000;
  ContactsPass pass(palpa::test::test_device());
  EXPECT_REFUSED(pass.prepare(many, {}), "many.glb: the scene's 20000 solids can take 70000 looks");
  geometry::Solid filed = cube();
  filed.file = "one.glb";
  EXPECT_EQ(prepare_solids({filed}).file, "one.glb");
}

TEST(PreparedSolids, AreKeptForTheSameParameters) {
  KeptSolids kept;
  FingerOptions parameters;
  const PreparedSolids own = prepare_solids({cube()}, parameters);
  EXPECT_EQ(kept.prepare({cube()}, parameters).planes.size(), own.planes.size());
  // Nothing is prepared again: even for no solids, it is what it was.
  EXPECT_EQ(kept.prepare({}, parameters).records.size(), 1u);
  parameters.delta_m *= 2;
  EXPECT_EQ(kept.prepare({}, parameters).records.size(), 0u);
}

TEST(PreparedSolids, ListFewPlanesWhereTheShellIs) {
  for (const geometry::Solid& solid : {cube(), half_ball({0.3, -0.02, 0}, 0.02, 700), ball({0, 1, 0}, 0.4, 5000)}) {
    const PreparedSolids solids = prepare_solids({solid});
    double listed = 0, cells = 0;
    for (const shader::PlaneCell& cell : solids.cells) {
      if (cell.deepest <= 0 || cell.shallowest > 1.5e-3F) continue;
      listed += cell.count;
      ++cells;
    }
    EXPECT_LT(listed / cells, 30) << solid.name;
    EXPECT_LT(solids.planes.size(), 400'000U) << solid.name;
  }
}

TEST(PreparedSolids, RefusesSolidsThatAreNone) {
  geometry::Solid bare = cube(), broken = cube();
  bare.planes.clear();
  broken.planes[2].offset = std::nan("");
  for (const geometry::Solid& solid : {bare, broken})
    EXPECT_ERROR(prepare_solids({solid}), Exit::usage, "solid 'cube' has no planes");
}

}  // namespace
}  // namespace palpa::touch::test
