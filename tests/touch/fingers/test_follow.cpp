// Identity and steady axes from frame to frame, with frames of fingers that are made by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using Ids = std::vector<std::uint32_t>;

/// A finger of about a fingertip's size; `section` as find_sections leaves it.
Finger finger_at(const glm::vec3& place, std::uint32_t solid = 0) {
  Finger finger;
  finger.solid = solid;
  finger.contacts.resize(100);
  finger.section.centroid = place;
  finger.section.axes = {glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0)};
  finger.section.eigenvalues = {16e-6F, 15e-6F, 0.2e-6F};
  return finger;
}

/// Frames, one after the other.
class Sequence {
 public:
  explicit Sequence(double memory_s = 0) : setting_{.follow = true, .memory_s = memory_s} {}

  const Touch& frame(std::vector<Finger> fingers, double time_s) {
    touch_.finger_count = static_cast<std::uint32_t>(fingers.size());
    touch_.fingers = std::move(fingers);
    touch_.contacts.clear();
    for (Finger& finger : touch_.fingers) {
      for (std::uint32_t& contact : finger.contacts) {
        contact = static_cast<std::uint32_t>(touch_.contacts.size());
        touch_.contacts.push_back({.solid = finger.solid, .position = finger.section.centroid});
      }
    }
    follow_fingers(tracks_, tracks_.clock.elapsed_us(time_s), setting_, touch_);
    return touch_;
  }
  void forget() { tracks_.clock = {}; }
  Ids ids(const std::vector<glm::vec3>& places, double time_s, std::uint32_t solid = 0) {
    std::vector<Finger> fingers;
    fingers.reserve(places.size());
    for (const glm::vec3& place : places)
      fingers.push_back(finger_at(place, solid));
    frame(std::move(fingers), time_s);
    Ids ids;
    for (const Finger& finger : touch_.fingers)
      ids.push_back(finger.id);
    return ids;
  }

 private:
  StageSetting setting_;
  Touch touch_;
  Tracks tracks_;
};

class Follow : public ::testing::Test {
 protected:
  Sequence sequence_;
};

constexpr double frame_90 = 1.0 / 90, frame_15 = 1.0 / 15;

TEST_F(Follow, KeepsIdsWhileTheOrderOfFingersChanges) {
  EXPECT_EQ(sequence_.ids({{0, 0, 0}, {0.05F, 0, 0}}, 0), (Ids{0, 1}));
  EXPECT_EQ(sequence_.ids({{0.051F, 0, 0}, {0.002F, 0, 0}}, frame_90), (Ids{1, 0}));
}

TEST_F(Follow, GivesNewIdsAtBirthAndRemembersForAWhile) {
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 0), (Ids{0}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}, {0.03F, 0, 0}}, 0.01), (Ids{0, 1}));
  EXPECT_EQ(sequence_.ids({{0.03F, 0, 0}}, 0.02), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}, {0.03F, 0, 0}}, 0.29), (Ids{0, 1}));  // away for 0.28 s
  EXPECT_EQ(sequence_.ids({}, 0.30), Ids{});
  EXPECT_EQ(sequence_.ids({}, 0.45), Ids{});
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 0.62), (Ids{2}));  // away for 0.33 s
}

TEST_F(Follow, RemembersForAsLongAsFramesMayBeApart) {
  Sequence patient(1.0);
  EXPECT_EQ(patient.ids({{0, 0, 0}}, 0), (Ids{0}));
  EXPECT_EQ(patient.ids({{0.003F, 0, 0}}, 0.4), (Ids{0}));
  EXPECT_EQ(patient.ids({{0, 0, 0}}, 1.3), (Ids{0}));
  EXPECT_EQ(patient.ids({{0, 0, 0}}, 2.4), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 0), (Ids{0}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 0.4), (Ids{1}));
  EXPECT_EQ(patient.ids({{0, 0, 0}}, 2), (Ids{2})) << "a clock that is set back is older than any memory";
}

TEST_F(Follow, ForgetsEverythingButTheIdsWhenTimeGoesBackOrStopsOrItIsToldTo) {
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 10), (Ids{0}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 9), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 9 + 7200), (Ids{2}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 9 + 7200), (Ids{2}));  // no time at all is no change
  sequence_.forget();
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 9 + 7200.01), (Ids{3}));
}

TEST_F(Follow, NeverAcrossSolidsNorTooFar) {
  sequence_.ids({{0, 0, 0}}, 0, 0);
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, frame_90, 1), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0.021F, 0, 0}}, 2 * frame_90, 1), (Ids{2}));
  EXPECT_EQ(sequence_.ids({{0.040F, 0, 0}}, 3 * frame_90, 1), (Ids{2}));
}

TEST_F(Follow, ABrieflyLostFingerDoesNotTakeASeenOnesPlace) {
  sequence_.ids({{0, 0, 0}, {0.014F, 0, 0}}, 0);
  // Finger 0 is gone; finger 1 moves to where that was.
  EXPECT_EQ(sequence_.ids({{0.014F, 0, 0}}, frame_90), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0.0065F, 0, 0}}, 2 * frame_90), (Ids{1}));
  EXPECT_EQ(sequence_.ids({{0, 0, 0}}, 3 * frame_90), (Ids{1}));
}

TEST_F(Follow, KeepsARowOfFingersApartAtHandSpeeds) {
  // Five fingers 20 mm apart, up to 1 m/s, along the row and across it; at 15 Hz a frame is 67 mm: three fingers.
  for (const double interval : {frame_90, frame_15}) {
    for (const double speed : {0.1, 0.5, 1.0}) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(-0.6, 0, 0.8)}) {
        Sequence sequence;
        std::mt19937 random(5);
        std::normal_distribution<float> jitter(0, 0.3e-3F);
        for (int k = 0; k < 8; ++k) {
          std::vector<glm::vec3> places;
          // A hand speeds up within 60 ms.
          const double t = k * interval, way = speed * (t < 0.06 ? t * t / 0.12 : t - 0.03);
          for (int f = 0; f < 5; ++f)
            places.emplace_back(Vec3(0.02 * f, 0, 0) + direction * way +
                                Vec3(jitter(random), jitter(random), jitter(random)));
          EXPECT_EQ(sequence.ids(places, t), (Ids{0, 1, 2, 3, 4}))
              << 1 / interval << " Hz, " << speed << " m/s, frame " << k;
        }
      }
    }
  }
}

TEST_F(Follow, FindsALostFingerWhereItMovedOn) {
  double t = 0, x = 0;
  for (int k = 0; k < 20; ++k, t += frame_90, x += 0.4 * frame_90)
    EXPECT_EQ(sequence_.ids({{x, 0, 0}}, t), (Ids{0}));
  // Hidden for 80 ms, 32 mm on, another finger where it was lost.
  const double lost = x;
  for (int k = 0; k < 7; ++k, t += frame_90, x += 0.4 * frame_90)
    sequence_.ids({}, t);
  EXPECT_EQ(sequence_.ids({{lost, 0, 0.012}, {x, 0, 0}}, t), (Ids{1, 0}));
}

TEST_F(Follow, TakesAsManyFingersAsThereCanBe) {
  std::vector<glm::vec3> places;
  Ids expected(max_fingers);
  std::iota(expected.begin(), expected.end(), 0U);
  for (std::uint32_t i = 0; i < max_fingers; ++i)
    places.emplace_back(0.02F * static_cast<float>(i % 8), 0, 0.02F * static_cast<float>(i / 8));
  EXPECT_EQ(sequence_.ids(places, 0), expected);
  for (int k = 1; k <= 5; ++k) {
    for (glm::vec3& place : places)
      place += glm::vec3(0.005F, 0, 0.004F);
    std::rotate(places.begin(), places.begin() + 7, places.end());
    std::rotate(expected.begin(), expected.begin() + 7, expected.end());
    EXPECT_EQ(sequence_.ids(places, k * frame_90), expected);
  }
  // All gone and others instead: as many are remembered as there is room for.
  for (glm::vec3& place : places)
    place.y += 0.5F;
  Ids later = sequence_.ids(places, 6 * frame_90);
  std::iota(expected.begin(), expected.end(), max_fingers);
  EXPECT_EQ(later, expected);
  for (glm::vec3& place : places)
    place.y += 0.5F;
  later = sequence_.ids(places, 7 * frame_90);
  std::iota(expected.begin(), expected.end(), 2 * max_fingers);
  EXPECT_EQ(later, expected);
}

/// The least sum of squared distances, in reaches, over all ways to continue tracks or to begin new ones at 2 each.
double least_cost(const std::vector<glm::vec3>& before, const std::vector<glm::vec3>& now, std::size_t next,
                  std::vector<bool>& taken, double reach) {
  if (next == now.size()) return 0;
  double best = 2 + least_cost(before, now, next + 1, taken, reach);
  for (std::size_t b = 0; b < before.size(); ++b) {
    const double apart = glm::distance(Vec3(before[b]), Vec3(now[next])) / reach;
    if (taken[b] || apart > 1) continue;
    taken[b] = true;
    best = std::min(best, apart * apart + least_cost(before, now, next + 1, taken, reach));
    taken[b] = false;
  }
  return best;
}

TEST_F(Follow, AssignsWithTheLeastSumOfSquares) {
  const double reach = 0.009 + frame_90;  // the documented 9 mm and 1 m/s
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Sequence sequence;
    const auto before = random_points(1 + seed % 6, Vec3(0), Vec3(0.03, 0.005, 0.03), seed);
    const auto now = random_points(1 + seed % 7, Vec3(0), Vec3(0.03, 0.005, 0.03), seed + 1000);
    sequence.ids(before, 0);
    const Ids ids = sequence.ids(now, frame_90);
    double cost = 0;
    for (std::size_t f = 0; f < now.size(); ++f) {
      const bool born = ids[f] >= before.size();
      const double apart = born ? 0 : glm::distance(Vec3(before[ids[f]]), Vec3(now[f])) / reach;
      EXPECT_LE(apart, 1 + 1e-6);
      cost += born ? 2 : apart * apart;
    }
    std::vector<bool> taken(before.size(), false);
    EXPECT_NEAR(cost, least_cost(before, now, 0, taken, reach), 1e-5) << "seed " << seed;
    EXPECT_EQ(std::set<std::uint32_t>(ids.begin(), ids.end()).size(), ids.size());
  }
}

/// A rotation about a unit axis.
glm::vec3 turned(const glm::vec3& v, const glm::vec3& axis, double angle) {
  const Vec3 a(axis), x(v);
  return glm::vec3(x * std::cos(angle) + glm::cross(a, x) * std::sin(angle) +
                   a * glm::dot(a, x) * (1 - std::cos(angle)));
}

/// A finger with principal axes (by design's rules of sign) about `normal`, the longer one `angle` from some direction.
Finger with_axes(const glm::vec3& normal, double angle, float l1, float l2) {
  Finger finger = finger_at({0, 0, 0});
  const glm::vec3 aside = glm::normalize(glm::cross(normal, glm::vec3(0.9F, 0.1F, -0.42F)));
  glm::vec3 w3 = normal, w1 = turned(aside, normal, angle);
  if (w3.y < 0) w3 = -w3;
  const glm::vec3 size = glm::abs(w1);
  const int largest = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  if (w1[largest] < 0) w1 = -w1;
  finger.section.axes = {w1, glm::cross(w3, w1), w3};
  finger.section.eigenvalues = {l1, l2, 0.2e-6F};
  return finger;
}

double angle_between(const glm::vec3& a, const glm::vec3& b) {
  return std::atan2(glm::length(glm::cross(Vec3(a), Vec3(b))), glm::dot(Vec3(a), Vec3(b)));
}

void expect_frame(const CrossSection& s, const glm::vec3& principal) {
  EXPECT_NEAR(glm::length(s.axes[0]), 1, 2e-6);
  EXPECT_NEAR(glm::length(s.axes[2]), 1, 2e-6);
  EXPECT_NEAR(glm::dot(s.axes[0], s.axes[2]), 0, 2e-6);
  EXPECT_LE(glm::distance(glm::cross(s.axes[2], s.axes[0]), s.axes[1]), 2e-6);
  const glm::vec3 along = s.turn.x * s.axes[0] + s.turn.y * s.axes[1];
  EXPECT_NEAR(std::abs(glm::dot(along, principal)), 1, 4e-6) << "turn is not where the principal direction is";
}

TEST_F(Follow, LeavesTheFirstFramesAxesAlone) {
  const Finger finger = with_axes(glm::normalize(glm::vec3(0.3F, 0.2F, -0.8F)), 1.1, 16e-6F, 15e-6F);
  const Touch& touch = sequence_.frame({finger}, 3);
  EXPECT_EQ(touch.fingers[0].section.axes, finger.section.axes);
  EXPECT_EQ(touch.fingers[0].section.turn, glm::vec2(1, 0));
}

TEST_F(Follow, ARoundCrossSectionsAxesDoNotTurnInTheirPlane) {
  // Equal eigenvalues except for noise, so the principal direction is arbitrary. The plane tumbles right through the
  // horizontal. Smallest rotations carry the axes along.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 2 * std::numbers::pi);
  std::uniform_real_distribution<float> less(0.85F, 1.0F);
  glm::vec3 w1{}, w3{};
  for (int k = 0; k < 120; ++k) {
    const double tumble = 0.05 * k;
    const glm::vec3 normal(0.3 * std::cos(tumble), 0.9 * std::cos(tumble), std::sin(tumble));
    const Finger finger = with_axes(glm::normalize(normal), any(random), 16e-6F, 16e-6F * less(random));
    const CrossSection s = sequence_.frame({finger}, k * frame_90).fingers[0].section;
    expect_frame(s, finger.section.axes[0]);
    EXPECT_NEAR(std::abs(glm::dot(s.axes[2], finger.section.axes[2])), 1, 2e-6);
    if (k > 0) {
      const double tilt = angle_between(w3, s.axes[2]);
      EXPECT_LT(tilt, 0.06) << k;
      EXPECT_LE(angle_between(w1, s.axes[0]), tilt + 1e-3) << k;
    }
    w1 = s.axes[0];
    w3 = s.axes[2];
  }
}

TEST_F(Follow, ALongCrossSectionsAxesAreThePrincipalOnesWithoutFlips) {
  glm::vec3 w1{};
  for (int k = 0; k < 200; ++k) {
    const Finger finger = with_axes({0, 1, 0}, 0.03 * k, 30e-6F, 6e-6F);  // 2.7 rad/s at 90 Hz, almost a whole turn
    const CrossSection s = sequence_.frame({finger}, k * frame_90).fingers[0].section;
    expect_frame(s, finger.section.axes[0]);
    if (k > 0) {
      EXPECT_NEAR(angle_between(w1, s.axes[0]), 0.03, 1e-4) << k;
      EXPECT_NEAR(std::abs(s.turn.x), 1, 1e-5);
    }
    w1 = s.axes[0];
  }
}

/// Frames in which the contacts are one point have no directions.
TEST_F(Follow, AxesOutlastFramesInWhichAFingerIsAPoint) {
  Finger point = finger_at({0, 0, 0});
  point.point_like = true;
  point.section.eigenvalues = {0, 0, 0};
  double time_s = 0;
  const auto axes = [&](const Finger& finger) {
    return sequence_.frame({finger}, time_s += frame_90).fingers[0].section.axes;
  };
  for (int points = 0; points < 4; ++points) {
    sequence_.forget();
    // A point has no axes to keep, so a finger that begins as one takes the first that it has.
    for (int i = 0; i < points; ++i)
      axes(point);
    const Finger first = with_axes({0, 1, 0}, 0.2 + points, 16e-6F, 15.9e-6F);
    const auto before = axes(first);
    EXPECT_EQ(before, first.section.axes) << points;
    for (int i = 0; i < points; ++i)
      axes(point);
    const auto after = axes(with_axes({0, 1, 0}, 1.4 + points, 16e-6F, 15.9e-6F));
    EXPECT_LT(angle_between(before[0], after[0]), 1e-3) << points;
    EXPECT_LT(angle_between(before[2], after[2]), 1e-3) << points;
  }
}

TEST_F(Follow, AxesSettleGentlyWhenACrossSectionBecomesLong) {
  sequence_.frame({with_axes({0, 1, 0}, 0, 16e-6F, 15.9e-6F)}, 0);
  glm::vec3 w1 = sequence_.frame({with_axes({0, 1, 0}, 0, 16e-6F, 15.9e-6F)}, frame_90).fingers[0].section.axes[0];
  Finger finger;
  double largest = 0;
  CrossSection s;
  for (int k = 2; k < 60; ++k) {
    // Suddenly three times as long as wide, at 80 degrees from w1.
    finger = with_axes({0, 1, 0}, 1.4, 30e-6F, 10e-6F / 3);
    s = sequence_.frame({finger}, k * frame_90).fingers[0].section;
    expect_frame(s, finger.section.axes[0]);
    largest = std::max(largest, angle_between(w1, s.axes[0]));
    w1 = s.axes[0];
  }
  EXPECT_LE(largest, 5.0 / 90 + 1e-4);  // 5 rad/s
  EXPECT_NEAR(std::abs(s.turn.x), 1, 1e-5);
}

/// A finger on a ridge along x: as thick across as it is high, in the covariance's eyes. `facing`: where depth grows
/// least.
Finger on_a_ridge(double angle, float l2, float l3, const glm::vec3& facing) {
  Finger finger = with_axes(turned({0, 1, 0}, {1, 0, 0}, angle), 0, 16e-6F, l2);
  finger.section.axes[0] = {1, 0, 0};
  finger.section.axes[1] = glm::cross(finger.section.axes[2], finger.section.axes[0]);
  finger.section.eigenvalues = {16e-6F, l2, l3};
  // Covariance times gradient, were the gradient 0.2 long.
  for (int i = 0; i < 3; ++i) {
    const glm::vec3& w = finger.section.axes[i];
    finger.section.lean += -0.2F * (finger.section.eigenvalues[i] + 1e-8F) * glm::dot(w, facing) * w;
  }
  return finger;
}

TEST_F(Follow, DepthSaysWhereAFingerFacesThatTheContactsDoNotShow) {
  // The covariance's thinnest direction is anywhere across the ridge, depth's gradient points upwards. Then depth leans
  // to one side from a frame to the next: w3 goes there within its 0.15 s, at no more than 5 rad/s.
  const glm::vec3 there = glm::normalize(glm::vec3(0, 1, 0.8F));
  glm::vec3 before = sequence_.frame({on_a_ridge(0.3, 1.0e-6F, 0.9e-6F, {0, 1, 0})}, 0).fingers[0].section.axes[2];
  EXPECT_NEAR(before.y, 1, 1e-5);
  double left = angle_between(before, there);
  for (int k = 1; k < 80; ++k) {
    const Touch& touch = sequence_.frame({on_a_ridge(0.1 * k, 1.0e-6F, 0.9e-6F, there)}, k * frame_90);
    const glm::vec3 w3 = touch.fingers[0].section.axes[2];
    EXPECT_LE(angle_between(before, w3), 5 * frame_90 + 1e-4) << k;
    EXPECT_LE(angle_between(w3, there), left + 1e-4) << k;
    left = angle_between(w3, there);
    before = w3;
  }
  EXPECT_LT(left, 0.01);
  // Without a slope of depth, it faces as before.
  for (int k = 80; k < 100; ++k) {
    Finger finger = on_a_ridge(0.1 * k, 1.0e-6F, 0.9e-6F, there);
    finger.section.lean = glm::vec3(0);
    EXPECT_LT(angle_between(before, sequence_.frame({finger}, k * frame_90).fingers[0].section.axes[2]), 1e-3) << k;
  }
}

}  // namespace
}  // namespace palpa::touch::test
