// Euclidean clusters on both backends, in clouds that fill each of the passes' lists, against region growing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"
#include "touch/points/regions.hpp"

namespace palpa::touch::test {
namespace {

/// Place i of a cubic lattice `wide` points across, in steps.
Vec3 lattice(int i, int wide) {
  const int y = i / wide % wide, z = i / (wide * wide);
  return {i % wide, y, z};
}

class ClustersOfContacts : public OnBothBackends {
 protected:
  Touch run(const std::vector<glm::vec3>& points, const FingerOptions& parameters) {
    return touch_on(GetParam(), points, {everything()}, parameters);
  }
  void expect_exact(const std::vector<glm::vec3>& points, double gap, std::uint32_t min_points = 1) {
    const FingerOptions parameters = everything_is_contact(gap, min_points);
    const Touch touch = run(points, parameters);
    ASSERT_EQ(touch.contacts.size(), points.size());
    EXPECT_EQ(not_regions(touch, parameters), "");
  }
};
INSTANTIATE_TEST_SUITE_P(, ClustersOfContacts, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

TEST_P(ClustersOfContacts, TiesAtTheToleranceAreTogether) {
  // Coordinates that single precision holds exactly, 3-4-5 triangles included.
  const float gap = 0.078125F, unit = gap / 5;
  const std::vector<glm::vec3> points{{0, 0, 0},
                                      {gap, 0, 0},
                                      {2 * gap, 0, 0},
                                      {0, 1, 0},
                                      {3 * unit, 1, 4 * unit},
                                      {-1, 0, 0},
                                      {-1, std::nextafter(gap, 1.0F), 0}};
  const Touch touch = run(points, everything_is_contact(gap));
  EXPECT_EQ(finger_of_contacts(touch), (std::vector<int>{0, 0, 0, 1, 1, 2, 3}));
}

TEST_P(ClustersOfContacts, NeedMinPoints) {
  std::vector<glm::vec3> points;
  points.reserve(4096);
  for (int size = 1; size <= 8; ++size) {
    for (int i = 0; i < size; ++i)
      points.emplace_back(0.1 * size, 1e-3 * i, 0);
  }
  for (std::uint32_t least = 0; least <= 9; ++least) {
    const Touch touch = run(points, everything_is_contact(2e-3, least));
    ASSERT_EQ(touch.finger_count, 9 - std::max(least, 1U)) << least;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      EXPECT_EQ(touch.fingers[f].contacts.size(), std::max(least, 1U) + f);
    }
  }
}

TEST_P(ClustersOfContacts, BeyondTheMostTheSmallestAreLeftOut) {
  // 150 clusters, of 3 to 7 points and two of 300, which begin where the first 64 have long begun.
  std::vector<glm::vec3> points;
  for (int row = 0; row < 300; ++row) {
    for (int i = 0; i < 150; ++i) {
      const int size = i == 100 || i == 149 ? 300 : 3 + i * 7 % 5;
      if (row < size) points.emplace_back(0.01 * i - 0.7, 1e-4 * row, 0);
    }
  }
  const FingerOptions parameters = everything_is_contact(1e-3, 3);
  const Touch touch = run(points, parameters);
  EXPECT_EQ(touch.cluster_count, 150u);
  ASSERT_EQ(touch.finger_count, max_fingers);
  EXPECT_EQ(not_regions(touch, parameters), "");
  EXPECT_EQ(touch.fingers[max_fingers - 1].contacts.size(), 300u);
}

TEST_P(ClustersOfContacts, OfDifferentSolidsNeverMix) {
  const std::vector<geometry::Solid> solids{box({-0.1, -0.1, -0.1}, {0, 0.1, 0.1}, "left"),
                                            box({0, -0.1, -0.1}, {0.1, 0.1, 0.1}, "right")};
  const auto points = random_points(5000, Vec3(-0.09), Vec3(0.09));
  const FingerOptions parameters = everything_is_contact(0.03);
  const Touch touch = touch_on(GetParam(), points, solids, parameters);
  EXPECT_EQ(touch.finger_count, 2u);
  EXPECT_EQ(not_regions(touch, parameters), "");
}

/// Pairs of tight crowds just out of each other's reach, in every direction and place relative to the cells; with
/// `bridged` the first point of each leans over, so that these two alone are in reach, and lists that begin with the
/// newest find them last.
std::vector<glm::vec3> pairs_of_crowds(int pairs, int size, double gap, bool bridged) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anywhere = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return Vec3(x, y, z);
  };
  std::vector<Vec3> centres, across;
  for (int i = 0; i < pairs; ++i) {
    centres.push_back(gap * (lattice(i, 8) * 4.0 + anywhere()));
    across.push_back(glm::normalize(anywhere()));
  }
  std::vector<glm::vec3> points;
  points.reserve(4096);
  for (int k = 0; k < size; ++k) {
    for (int i = 0; i < pairs; ++i) {
      const double lean = bridged && k == 0 ? 0.02 : 0;
      for (const double side : {-1.0, 1.0}) {
        points.emplace_back(centres[i] + side * gap * (0.51 - lean) * across[i] + 0.003 * gap * anywhere());
      }
    }
  }
  return points;
}

TEST_P(ClustersOfContacts, CrowdsJoinedByOnePairAreFound) {
  const double gap = 5e-3;
  for (const int size : {7, 40}) {
    EXPECT_EQ(run(pairs_of_crowds(256, size, gap, false), everything_is_contact(gap)).cluster_count, 512u) << size;
    EXPECT_EQ(run(pairs_of_crowds(256, size, gap, true), everything_is_contact(gap)).cluster_count, 256u) << size;
  }
}

TEST_P(ClustersOfContacts, CrowdsJoinedByOnePairAreFoundEvenIfTheListIsFull) {
  // A lattice with a crowd in the middle of every block, whose neighbours along x and y fill the list; only along z do
  // first points lean over to each other.
  const double gap = 0.01, spacing = gap * 1.039;
  std::vector<glm::vec3> points;
  points.reserve(4096);
  for (int k = 0; k < 6; ++k) {
    for (int i = 0; i < 8 * 8 * 8; ++i) {
      const double lean = k == 0 ? gap * (i / 64 % 2 == 0 ? 0.025 : -0.025) : 0;
      points.emplace_back(glm::dvec3(0.26 * gap) + spacing * lattice(i, 8) + Vec3(0, 0, lean + 1e-6 * k));
    }
  }
  EXPECT_EQ(run(points, everything_is_contact(gap)).cluster_count, 256U);
  expect_exact(points, gap);
}

TEST_P(ClustersOfContacts, MoreCrowdsThanTheListHoldsAreStillExact) {
  // Six contacts in every block of a lattice just too wide: each block has thirteen crowded neighbours.
  const double gap = 0.01, spacing = gap * 1.03;
  std::vector<glm::vec3> points;
  points.reserve(4096);
  for (int i = 0; i < 6 * 6 * 6; ++i) {
    const glm::vec3 at(spacing * lattice(i, 6));
    for (int k = 0; k < 6; ++k)
      points.push_back(at + glm::vec3(1e-5F * static_cast<float>(k), 0, 0));
  }
  expect_exact(points, gap);
  points.emplace_back(spacing * 2.5, spacing * 2, spacing * 2);  // joins two of them
  expect_exact(points, gap);
  const Touch touch = run(points, everything_is_contact(gap));
  EXPECT_EQ(touch.cluster_count, 215u);
}

TEST_P(ClustersOfContacts, MoreNeighboursThanTheListHoldsAreStillExact) {
  // One contact in every block: nearly thirteen neighbours each, of which six have room on the list.
  const double gap = 0.01, block = gap * 1.04;
  const int wide = 12;
  const auto leaning = random_points(wide * wide * wide, Vec3(-0.15 * gap), Vec3(0.15 * gap));
  std::vector<glm::vec3> points;
  points.reserve(leaning.size());
  for (int i = 0; i < wide * wide * wide; ++i)
    points.push_back(glm::vec3(block * (lattice(i, wide) + 0.5)) + leaning[static_cast<std::size_t>(i)]);
  expect_exact(points, gap);
}

TEST_P(ClustersOfContacts, AHundredThousandContactsAreOneBlobAtAnyLargeTolerance) {
  const auto points = random_points(100'000, Vec3(-0.05), Vec3(0.05));
  for (const double gap : {5e-3, 50e-3}) {
    const Touch touch = run(points, everything_is_contact(gap, 5));
    ASSERT_EQ(touch.finger_count, 1u);
    EXPECT_EQ(touch.fingers[0].contacts.size(), points.size());
  }
}

TEST(TouchParameters, AreRefusedWhereTheyAreUnusable) {
  const auto refuse = [](const FingerOptions& parameters, const std::string& fault) {
    EXPECT_ERROR(Stage({cube()}, {}, {.parameters = parameters}), Exit::usage, fault);
  };
  for (const double bad : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    refuse({.delta_m = bad}, "delta is ");
    refuse({.finger_gap_m = bad}, "finger gap is ");
  }
  for (const double bad : {-1e-3, std::nan(""), double{INFINITY}})
    refuse({.finger_width_m = bad}, fmt::format("finger width is {} m", bad));
  refuse({.foci = 0}, "0 foci");
  refuse({.foci = max_foci + 1}, "65 foci");
  // 30,000 blocks of 1.04 gaps reach from the cube's centre as far as its corners, since it may be turned.
  const double least = 0.02 * std::numbers::sqrt3 / (30'000 * 1.04);
  refuse({.finger_gap_m = 0.999 * least}, "needs at least ");
  for (const double good : {1.001 * least, 1e30})
    EXPECT_NO_THROW(Stage({cube()}, {}, {.parameters = {.finger_gap_m = good}})) << good;
}

TEST(TouchParameters, TheGapThatARefusalNamesWillDo) {
  for (const double size : {0.013, 0.04, 0.3, 7.0}) {
    const std::vector solids{box(Vec3(-size, -size, -size), Vec3(size, 0, size))};
    const auto stage = [&](double gap_m) { Stage(solids, {}, {.parameters = {.finger_gap_m = gap_m}}); };
    const std::string said = palpa::test::error_of([&] { stage(1e-9); }, Exit::usage);
    const auto named = [&](const std::string& before) {
      const std::size_t at = said.find(before);
      return at == std::string::npos ? 0 : std::stod(said.substr(at + before.size()));
    };
    EXPECT_NO_THROW(stage(named("at least "))) << said;
    EXPECT_NEAR(named("a solid of "), 2 * size, 1e-2 * size) << said;
  }
}

}  // namespace
}  // namespace palpa::touch::test
