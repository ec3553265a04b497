// Methods: the places of each method's foci for the same finger, point-like fingers, fallbacks.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "base/math.hpp"
#include "touch/fingers/sections.hpp"
#include "touch/fingers/sectors.hpp"
#include "touch/methods/method.hpp"

namespace palpa::touch::test {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// Contacts along an ellipse in a tilted plane, from one angle to another: one finger.
struct Ring {
  Vec3 centre{0.01, -0.02, 0.03};
  double major = 8e-3, minor = 5e-3, noise = 0;
  Vec3 u, v;  ///< along the axes

  Ring() {
    u = glm::normalize(Vec3(1, 0.2, -0.3));
    v = glm::normalize(glm::cross(Vec3(0.1, 1, 0.2), u));
  }
  Vec3 at(double t) const { return centre + major * std::cos(t) * u + minor * std::sin(t) * v; }
  /// By the radius; 0 on the ellipse.
  double off(const glm::vec3& p) const {
    const Vec3 d = Vec3(p) - centre;
    return std::hypot(glm::dot(d, u) / major, glm::dot(d, v) / minor) - 1;
  }
  double off_plane(const glm::vec3& p) const { return glm::dot(Vec3(p) - centre, glm::cross(u, v)); }
  Touch touch(double from, double to, int count, std::uint32_t foci = 10) const {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;  // of width 1, because 0 is not a valid width
    Touch out;
    out.fingers.resize(1);
    out.finger_count = 1;
    for (int i = 0; i < count; ++i) {
      const Vec3 p = at(from + (to - from) * i / count) + noise * Vec3(normal(random), normal(random), normal(random));
      out.contacts.push_back({static_cast<std::uint32_t>(i), 0, 1e-3F, glm::vec3(p)});
      out.fingers[0].contacts.push_back(static_cast<std::uint32_t>(i));
    }
    out.fingers[0].contact_count = static_cast<std::uint32_t>(count);
    FingerOptions parameters;
    parameters.foci = foci;
    find_sections(out);
    find_foci(parameters, {}, out);
    return out;
  }
};

Placement placed(const Touch& touch, const MethodOptions& options) {
  Placement placement;
  place_foci(touch, touch.fingers.at(0), options, placement);
  return placement;
}

std::uint32_t contacts_in(const Placement& placement) {
  std::uint32_t sum = 0;
  for (const Focus& focus : placement.foci)
    sum += focus.points;
  return sum;
}

TEST(Method, CrossSectionIsThePapersSectors) {
  const Touch touch = Ring().touch(0, turn, 300);
  const Placement placement = placed(touch, {.method = Method::cross_section});
  ASSERT_EQ(placement.foci.size(), 10u);
  for (std::size_t n = 0; n < 10; ++n) {
    EXPECT_EQ(placement.foci[n].position, touch.fingers[0].foci[n].position);
    EXPECT_EQ(placement.foci[n].points, touch.fingers[0].foci[n].points);
  }
  EXPECT_FALSE(placement.together || placement.still() || placement.complete);
}

TEST(Method, AnotherNumberOfSectorsIsWhatTheTwinFindsForIt) {
  Ring ring;
  ring.noise = 3e-4;
  for (const std::uint32_t foci : {3u, 7u, 16u, 23u, 64u}) {
    const Touch asked = ring.touch(0, 5.0, 400, 10), exact = ring.touch(0, 5.0, 400, foci);
    const Placement placement = placed(asked, {.method = Method::cross_section, .foci = foci});
    ASSERT_EQ(placement.foci.size(), foci);
    std::uint32_t moved = 0;
    for (std::size_t n = 0; n < foci; ++n) {
      const Focus &a = placement.foci[n], &b = exact.fingers[0].foci[n];
      if (a.points != b.points) {
        ++moved;  // a contact within rounding of a border
      } else if (a.points != 0) {
        EXPECT_LT(glm::distance(a.position, b.position), 1e-6F) << foci << " " << n;
      }
    }
    EXPECT_LE(moved, 2u);
    EXPECT_EQ(contacts_in(placement), 400u);
  }
}

TEST(Method, SingleFocusIsTheCentroid) {
  const Touch touch = Ring().touch(0, turn, 300);
  const Placement placement = placed(touch, {.method = Method::single_focus});
  ASSERT_EQ(placement.foci.size(), 1u);
  EXPECT_EQ(placement.foci[0].position, touch.fingers[0].section.centroid);
  EXPECT_EQ(placement.foci[0].points, 300u);
  EXPECT_TRUE(placement.still());
  EXPECT_FALSE(placement.together);
}

TEST(Method, MultiFocusIsTheCrossSectionAtOnce) {
  const Touch touch = Ring().touch(0, 4, 300);
  const Placement placement = placed(touch, {.method = Method::multi_focus});
  const Placement cross_section = placed(touch, {.method = Method::cross_section});
  EXPECT_TRUE(placement.together && placement.still());
  ASSERT_EQ(placement.foci.size(), cross_section.foci.size());
  for (std::size_t n = 0; n < placement.foci.size(); ++n) {
    EXPECT_EQ(placement.has(n), cross_section.has(n));
    EXPECT_TRUE(!placement.has(n) || placement.foci[n].position == cross_section.foci[n].position);
  }
}

TEST(Method, EllipseFociLieOnTheEllipseInTheSectorsOrder) {
  const Ring ring;
  const Touch touch = ring.touch(0, turn, 500);
  for (const bool equal_arc : {false, true}) {
    const Placement placement = placed(touch, {.method = Method::ellipse, .equal_arc = equal_arc});
    ASSERT_EQ(placement.foci.size(), 10u);
    EXPECT_TRUE(placement.complete);
    EXPECT_EQ(contacts_in(placement), 500u);
    for (std::size_t n = 0; n < 10; ++n) {
      const Focus& focus = placement.foci[n];
      EXPECT_NEAR(ring.off(focus.position), 0, 1e-4);
      EXPECT_NEAR(ring.off_plane(focus.position), 0, 1e-7);
      // The same way round and from the same axis as the sectors.
      const double apart = glm::distance(focus.position, touch.fingers[0].foci[n].position);
      EXPECT_LT(apart, equal_arc ? 2e-3 : 3e-4) << n;
    }
  }
}

TEST(Method, EllipseStepsAreEqualInParameterOrInLength) {
  Ring ring;
  ring.minor = 2e-3;
  const Touch touch = ring.touch(0, turn, 2000);
  const auto gaps = [&](bool equal_arc) {
    const Placement p = placed(touch, {.method = Method::ellipse, .equal_arc = equal_arc, .foci = 40});
    double least = 1, most = 0;
    for (std::size_t n = 0; n < 40; ++n) {
      const double gap = glm::distance(p.foci[n].position, p.foci[(n + 1) % 40].position);
      least = std::min(least, gap);
      most = std::max(most, gap);
    }
    return most / least;
  };
  EXPECT_GT(gaps(false), 3);
  EXPECT_LT(gaps(true), 1.1);
}

TEST(Method, EllipseBridgesSkinThatWasNotSeen) {
  Ring ring;
  ring.noise = 2e-5;
  const Touch touch = ring.touch(0.3, 0.3 + 0.6 * turn, 300);
  const Placement placement = placed(touch, {.method = Method::ellipse});
  for (const Focus& focus : placement.foci)
    EXPECT_NEAR(ring.off(focus.position), 0, 0.1);
  EXPECT_EQ(contacts_in(placement), 300u);
}

TEST(Method, EllipseStaysNearContactsThatTellNothing) {
  // A short, noisy arc, a patch, and six contacts: no focus may fly off.
  for (const double part : {0.02, 0.05, 0.1, 0.2}) {
    Ring ring;
    ring.noise = 4e-4;
    const Touch touch = ring.touch(1, 1 + part * turn, 60);
    const Finger& finger = touch.fingers[0];
    double farthest = 0;
    for (const Contact& contact : touch.contacts)
      farthest = std::max<double>(farthest, glm::distance(contact.position, finger.section.centroid));
    for (const Focus& focus : placed(touch, {.method = Method::ellipse}).foci)
      EXPECT_LT(glm::distance(focus.position, finger.section.centroid), 3.1 * farthest) << part;
  }
}

TEST(Method, FewContactsGetTheEllipseOfTheirCovariance) {
  const Ring ring;
  for (const int count : {3, 4, 5}) {
    const Touch touch = ring.touch(0, turn, count);
    const Placement placement = placed(touch, {.method = Method::ellipse});
    ASSERT_EQ(placement.foci.size(), 10u);
    for (const Focus& focus : placement.foci)
      EXPECT_NEAR(ring.off(focus.position), 0, 1e-3) << count << ": evenly spread contacts have the ellipse's own";
  }
}

TEST(Method, PointLikeFingersHaveOneFocusUnderEveryMethod) {
  Ring ring;
  ring.minor = 0;
  for (const int count : {1, 2, 30}) {
    const Touch touch = ring.touch(0, turn, count);
    ASSERT_TRUE(touch.fingers[0].point_like) << count;
    for (const auto& [word, method] : method_words) {
      const Placement placement = placed(touch, {.method = method, .foci = 7});
      ASSERT_EQ(placement.foci.size(), 1u) << word;
      EXPECT_EQ(placement.foci[0].position, touch.fingers[0].section.centroid);
      EXPECT_TRUE(placement.still() && !placement.together && placement.has(0));
    }
  }
}

TEST(Method, FociStandStillAndSoundTogetherAsTheMethodSays) {
  const Touch touch = Ring().touch(0, turn, 300);
  for (const auto& [word, method] : method_words) {
    const Placement placement = placed(touch, {.method = method});
    EXPECT_EQ(placement.still(), stands_still(method)) << word;
    EXPECT_EQ(placement.together, sounds_together(method)) << word;
  }
}

TEST(Method, AllocatesNothingOnceItHasGrown) {
  const Touch touch = Ring().touch(0, turn, 300, max_foci);
  Placement placement;
  placement.foci.reserve(max_foci);
  const void* storage = placement.foci.data();
  for (const auto& [word, method] : method_words) {
    place_foci(touch, touch.fingers[0], {.method = method}, placement);
    EXPECT_EQ(placement.foci.data(), storage) << word;
  }
}

TEST(Perimeter, OfACircleIsExact) {
  for (const int corners : {3, 5, 10, 64}) {
    Placement placement;
    for (int n = 0; n < corners; ++n) {
      const double t = turn * n / corners;
      placement.foci.push_back({{0.01 * std::cos(t), 0.3, 0.01 * std::sin(t)}, 1});
    }
    EXPECT_NEAR(perimeter_of(placement), 0.01 * turn, 1e-7) << corners;
    placement.foci.push_back({{9, 9, 9}, 0});  // an empty sector
    EXPECT_NEAR(perimeter_of(placement), 0.01 * turn, 1e-7) << corners;
  }
  EXPECT_EQ(perimeter_of({}), 0);
  Placement two;
  two.foci = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
  EXPECT_EQ(perimeter_of(two), 0);
}

}  // namespace
}  // namespace palpa::touch::test
