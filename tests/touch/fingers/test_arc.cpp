// Foci at equal arc lengths, and a solid's own number of foci.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

/// Points of an ellipse's rim in the plane y = 0, evenly along it, a band of 0.8 mm. With `open`, points less than 36
/// degrees from the z axis are left out.
std::vector<glm::vec3> rim(double a, double b, std::uint32_t count, unsigned seed, bool open = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::vec3> points;
  // Angles are kept in proportion to the rim's length there.
  const double most = std::max(a, b);
  while (points.size() < count) {
    const double angle = 2 * std::numbers::pi * unit(random),
                 speed = std::hypot(a * std::sin(angle), b * std::cos(angle));
    if (unit(random) * most > speed || (open && std::abs(std::sin(angle)) > std::cos(0.2 * std::numbers::pi))) continue;
    const double wide = 1 + (unit(random) - 0.5) * 0.8e-3 / most;
    points.emplace_back(a * wide * std::cos(angle), 2e-4 * (unit(random) - 0.5), b * wide * std::sin(angle));
  }
  return points;
}

Finger finger_of(const std::vector<glm::vec3>& points, Spacing spacing, std::uint32_t foci = 10) {
  FingerOptions parameters = everything_is_contact(0.05);
  parameters.spacing = spacing;
  parameters.foci = foci;
  return touch_on(Backend::cpu, points, {everything()}, parameters).fingers.at(0);
}

/// Largest gap between neighbouring foci over the smallest.
double unevenness(const Finger& finger) {
  double least = 1e300, most = 0;
  for (std::size_t n = 0; n < finger.foci.size(); ++n) {
    EXPECT_GT(finger.foci[n].points, 0u);
    const double gap = glm::distance(finger.foci[n].position, finger.foci[(n + 1) % finger.foci.size()].position);
    least = std::min(least, gap);
    most = std::max(most, gap);
  }
  return most / least;
}

TEST(Arc, SpacesTheFociOfAnEllipseEvenly) {
  for (const double length : {5e-3, 8e-3, 12e-3, 16e-3}) {
    SCOPED_TRACE(length);
    const auto points = rim(length, 4e-3, 3000, 2);
    const double angle = unevenness(finger_of(points, Spacing::angle));
    const double arc = unevenness(finger_of(points, Spacing::arc));
    // Not 1: a sector that goes round the sharp end has its centroid well inside of the rim.
    EXPECT_LT(arc, 1.9);
    if (length > 6e-3) {
      EXPECT_LT(arc, 0.9 * angle);
    }
  }
}

TEST(Arc, CutsAnOutlineIntoPiecesOfEqualLength) {
  // The rim's points are evenly along it, so that equal lengths have equally many: an independent measure.
  for (const std::uint32_t foci : {1U, 2U, 3U, 7U, 10U, 24U, 64U}) {
    const Finger finger = finger_of(rim(12e-3, 4e-3, 30'000, 3), Spacing::arc, foci);
    ASSERT_EQ(finger.foci.size(), foci);
    std::uint32_t members = 0;
    for (const Focus& focus : finger.foci) {
      EXPECT_NEAR(focus.points, 30'000.0 / foci, 0.06 * 30'000 / foci + 40) << foci;
      members += focus.points;
    }
    EXPECT_EQ(members, 30'000u);
  }
}

TEST(Arc, ClosesAnOutlineWhereThereAreNoContacts) {
  // A circle without the sectors 2 and 7, and without half of their neighbours.
  const Finger finger = finger_of(rim(8e-3, 8e-3, 30'000, 3, true), Spacing::arc);
  ASSERT_EQ(finger.foci.size(), 10u);
  constexpr double seen[] = {1, 0.5, 0, 0.5, 1, 1, 0.5, 0, 0.5, 1};
  for (std::size_t n = 0; n < 10; ++n)
    EXPECT_NEAR(finger.foci[n].points, seen[n] * 5000, 500) << n;
}

TEST(Arc, EverySolidMayHaveItsOwnNumberOfFoci) {
  std::vector<geometry::Solid> solids{box(Vec3(-1, -1, -1), Vec3(0, 1, 1), "left"),
                                      box(Vec3(0.01, -1, -1), Vec3(1), "right")};
  solids[1].haptics.foci = 7;
  auto points = rim(8e-3, 5e-3, 1000, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].x += i < 500 ? -0.05F : 0.05F;
  const Touch touch = touch_on(Backend::cpu, points, solids, everything_is_contact());
  ASSERT_EQ(touch.finger_count, 2u);
  EXPECT_EQ(touch.fingers[0].foci.size(), 10u);
  EXPECT_EQ(touch.fingers[1].foci.size(), 7u);
  for (const Focus& focus : touch.fingers[1].foci)
    EXPECT_GT(focus.points, 0u);
  solids[1].haptics.foci = 65;
  EXPECT_ERROR(touch_on(Backend::cpu, points, solids, everything_is_contact()), Exit::usage,
               "solid 'right' asks for 65 foci");
}

}  // namespace
}  // namespace palpa::touch::test
