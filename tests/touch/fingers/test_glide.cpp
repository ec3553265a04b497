// Steady axes and gliding foci against an independent computation in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "touch/fingers/glide_stream.hpp"
#include "touch/fingertips.hpp"

namespace palpa::touch::test {
namespace {

// ---- docs/touch-frames.md in doubles ----

/// The reference for one finger that is seen in every frame.
class Reference {
 public:
  /// Takes the contacts of the finger.
  void turn(const Touch& touch, const Finger& finger, double dt) {
    Vec3 centroid(0), lean(0);
    for (const std::uint32_t i : finger.contacts)
      centroid += Vec3(touch.contacts[i].position) / static_cast<double>(finger.contacts.size());
    glm::dmat3 c(0);
    for (const std::uint32_t i : finger.contacts) {
      const Vec3 d = Vec3(touch.contacts[i].position) - centroid;
      c += glm::outerProduct(d, d) / static_cast<double>(finger.contacts.size());
      lean += d * static_cast<double>(touch.contacts[i].depth_m) / static_cast<double>(finger.contacts.size());
    }
    const Vec3 gradient = -(glm::inverse(c + glm::dmat3(1e-8)) * lean);
    const std::array<double, 3> l = eigenvalues(c);
    const double clear = std::clamp((0.5 - l[2] / l[1]) / 0.35, 0.0, 1.0);
    const Vec3 thin = smallest_axis(c, l);
    const Vec3 before = begun_ ? w3 : upwards(thin);
    const Vec3 facing = facing_of(nearer(thin, before), nearer(gradient, before), clear, before);
    if (begun_) {
      const double share = clear == 1 ? 1 : dt / (dt + 0.15 * (1 - clear));
      const Vec3 way = facing - before;
      w3 = glm::normalize(before + way * std::min(share, 5 * dt / std::max(glm::length(way), 1e-12)));
      // The smallest rotation, about the axis across both.
      const Vec3 across = glm::cross(before, w3);
      const double angle = std::atan2(glm::length(across), glm::dot(before, w3));
      if (angle > 1e-12) w1 = turned(w1, glm::normalize(across), angle);
    } else {
      w3 = upwards(facing);
      w1 = glm::normalize(glm::cross(Vec3(0.3, 0.2, 0.9), w3));
    }
    const Vec3 w2 = glm::cross(w3, w1);
    const double xx = glm::dot(w1, c * w1), xy = glm::dot(w1, c * w2), yy = glm::dot(w2, c * w2);
    double principal = std::atan2(2 * xy, xx - yy) / 2;  // within a quarter turn: the nearer direction
    if (begun_) {
      const double e = std::hypot(xx - yy, 2 * xy) / (xx + yy);
      const double beyond = dt * (e - 0.1);
      const double share = e <= 0.1 ? 0 : e >= 0.5 ? 1 : beyond / (beyond + 0.1 * (0.5 - e));
      principal = std::atan2(share * std::sin(principal), 1 - share + share * std::cos(principal));
      const double most = std::asin(std::min(5 * dt, 0.7));
      principal = std::clamp(principal, -most, most);
    }
    w1 = turned(w1, w3, principal);
    if (!begun_) {
      const int largest = std::abs(w1.x) >= std::abs(w1.y) ? (std::abs(w1.x) >= std::abs(w1.z) ? 0 : 2)
                                                           : (std::abs(w1.y) >= std::abs(w1.z) ? 1 : 2);
      if (w1[largest] < 0) w1 = -w1;
    }
    begun_ = true;
  }

  /// Takes the axes, centroid and foci that a stage without smoothing found.
  std::vector<Vec3> glide(const Finger& raw, double dt) {
    const std::size_t count = raw.foci.size();
    const Vec3 centroid(raw.section.centroid);
    const glm::dmat3 axes(Vec3(raw.section.axes[0]), Vec3(raw.section.axes[1]), Vec3(raw.section.axes[2]));
    const auto target = [&](std::size_t n) {
      std::size_t best = count, apart = count;
      for (std::size_t m = 0; m < count; ++m) {
        const std::size_t far = m > n ? m - n : n - m, around = std::min(far, count - far);
        if (raw.foci[m].points == 0 || around >= apart) continue;
        best = m;
        apart = around;
      }
      return Vec3(raw.foci[best].position);
    };
    if (places_.size() != count) {
      places_.resize(count);
      speeds_.assign(count, Vec3(0));
      empty_s_.assign(count, 0);
      for (std::size_t n = 0; n < count; ++n) {
        places_[n] = target(n);
        empty_s_[n] = raw.foci[n].points ? 0 : 1;
      }
      velocity_ = Vec3(0);
    } else {
      const Vec3 expected = velocity_ * std::min(dt, 0.1), surprise = centroid - centroid_ - expected;
      const Vec3 motion = dt == 0 ? surprise : expected + surprise * dt / (dt + 0.005);
      for (std::size_t n = 0; n < count; ++n) {
        const Vec3 carried = centroid_ + motion + axes * (glm::transpose(axes_) * (places_[n] - centroid_));
        places_[n] = carried;
        empty_s_[n] = raw.foci[n].points ? 0 : empty_s_[n] + dt;
        if (dt == 0) continue;
        const Vec3 way = empty_s_[n] > 0 && empty_s_[n] <= 0.05 ? Vec3(0) : target(n) - carried;
        const auto pass = [&](double hz) { return dt / (dt + 1 / (2 * std::numbers::pi * hz)); };
        speeds_[n] += (way / dt - speeds_[n]) * pass(2);
        const Vec3 step = way * pass(4 + 500 * glm::length(speeds_[n]));
        places_[n] += step * std::min(1.0, 0.05 * dt / std::max(glm::length(step), 1e-15));
      }
      if (dt > 0) velocity_ += surprise / (dt + 0.03);
    }
    centroid_ = centroid;
    axes_ = axes;
    return places_;
  }

  Vec3 w1{}, w3{};

 private:
  static Vec3 nearer(const Vec3& axis, const Vec3& before) { return glm::dot(axis, before) < 0 ? -axis : axis; }
  static Vec3 upwards(const Vec3& axis) { return axis.y < 0 ? -axis : axis; }
  static Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
           axis * glm::dot(axis, v) * (1 - std::cos(angle));
  }
  static Vec3 facing_of(const Vec3& thin, const Vec3& gradient, double clear, const Vec3& before) {
    const double length = glm::length(gradient), trust = std::min(length / 0.1, 1.0);
    const Vec3 by_depth = gradient / length * trust + before * (1 - trust);
    return glm::normalize(thin * clear + by_depth * (1 - clear));
  }
  /// Roots of the characteristic polynomial, descending.
  static std::array<double, 3> eigenvalues(const glm::dmat3& m) {
    const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
    const glm::dmat3 k = m - glm::dmat3(mean);
    double square = 0;
    for (int i = 0; i < 3; ++i)
      square += glm::dot(k[i], k[i]);
    const double p = std::sqrt(square / 6);
    const double angle = std::acos(std::clamp(glm::determinant(k / p) / 2, -1.0, 1.0)) / 3;
    const double most = mean + 2 * p * std::cos(angle),
                 least = mean + 2 * p * std::cos(angle + 2 * std::numbers::pi / 3);
    return {most, 3 * mean - most - least, least};
  }
  static Vec3 smallest_axis(const glm::dmat3& m, const std::array<double, 3>& l) {
    const glm::dmat3 k = m - glm::dmat3(l[2]);
    Vec3 best(0);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      const Vec3 normal = glm::cross(k[a], k[b]);
      if (glm::length(normal) > glm::length(best)) best = normal;
    }
    return glm::normalize(best);
  }

  bool begun_ = false;
  std::vector<Vec3> places_, speeds_;
  std::vector<double> empty_s_;
  Vec3 centroid_{}, velocity_{};
  glm::dmat3 axes_{1};
};

/// A walk of one finger with all that makes foci jump: few contacts, time that varies and stands still. The last frames
/// come at less than 10 Hz.
struct Walk {
  std::string object;
  std::uint32_t foci = 10, points = 1500;
  double depth = 3e-3;
};

std::vector<glm::vec3> skin_of(const Walk& walk, int k, double t) {
  // The prism's ridge and the pyramid's top are sharp: the finger leaves them within 2 mm.
  const double reach = walk.object == "cube" ? 0.016 : 0.6e-3, along = walk.object == "pyramid" ? 0.6e-3 : 6e-3;
  return fingertip(walk.points, walk.depth + 0.5e-3 * std::sin(9 * t), reach * std::sin(3 * t),
                   along * std::sin(2.1 * t), static_cast<unsigned>(k / 2), 0.5e-3);
}

double step_of(int k) {
  return k >= 100 ? 0.125 : k % 17 == 5 ? 0 : k % 11 == 3 ? 4 * frame_90 : k % 5 == 1 ? 2 * frame_90 : frame_90;
}

const Walk walks[] = {{"cube"},           {"cube", 3},          {"cube", 20, 900}, {"prism", 10, 20000},
                      {"prism", 7, 9000}, {"pyramid", 6, 30000}};

TEST(Glide, AxesAndFociAreThoseOfAnIndependentComputation) {
  std::size_t held = 0, empty = 0;
  for (const Walk& walk : walks) {
    Stream raw(object(walk.object), setting_of(walk.foci, Smoothing::none));
    Stream smooth(object(walk.object), setting_of(walk.foci, Smoothing::one_euro));
    Reference reference;
    double t = 0;
    for (int k = 0; k < 112; ++k) {
      SCOPED_TRACE(walk.object + " frame " + std::to_string(k));
      const double dt = step_of(k);
      t += dt;
      const auto skin = skin_of(walk, k, t);
      const Touch& touch = raw.frame(skin, t);
      ASSERT_EQ(touch.finger_count, 1u);
      const Finger& from = touch.fingers[0];
      ASSERT_EQ(from.id, 0u);
      ASSERT_FALSE(from.point_like);
      EXPECT_FALSE(from.placed);
      reference.turn(touch, from, dt);
      EXPECT_NEAR(glm::distance(reference.w3, Vec3(from.section.axes[2])), 0, 1e-3);
      EXPECT_NEAR(glm::distance(reference.w1, Vec3(from.section.axes[0])), 0, 3e-3);
      const Finger& finger = smooth.frame(skin, t).fingers[0];
      EXPECT_EQ(finger.section.axes, from.section.axes);
      EXPECT_TRUE(finger.placed);
      const std::vector<Vec3> expected = reference.glide(from, dt);
      ASSERT_EQ(finger.foci.size(), expected.size());
      for (std::size_t n = 0; n < expected.size(); ++n) {
        EXPECT_NEAR(glm::distance(Vec3(finger.foci[n].position), expected[n]), 0, 2e-6) << "focus " << n;
        EXPECT_EQ(finger.foci[n].points, from.foci[n].points);
        empty += from.foci[n].points == 0 ? 1 : 0;
        held += finger.foci[n].held ? 1 : 0;
      }
    }
  }
  EXPECT_GT(held, 20u);
  EXPECT_GT(empty, held);
}

TEST(Glide, AFingerThatComesBackSoonContinuesAndLaterRestarts) {
  Stream stream({cube()}, setting_of(10, Smoothing::one_euro));
  Stream fresh({cube()}, setting_of(10, Smoothing::none));
  const auto at = [](double x, unsigned seed) { return fingertip(1500, 3e-3, x, 0, seed); };
  for (int k = 0; k < 5; ++k)
    stream.frame(at(0, 1), k * frame_90);
  stream.frame({}, 5 * frame_90);
  const Finger soon = stream.frame(at(4e-3, 2), 6 * frame_90).fingers.at(0);
  EXPECT_EQ(soon.id, 0u);
  for (int k = 7; k < 20; ++k)
    stream.frame({}, k * frame_90);
  const Finger later = stream.frame(at(0, 3), 20 * frame_90).fingers.at(0);
  const Finger alone = fresh.frame(at(0, 3), 0).fingers.at(0);
  ASSERT_EQ(later.id, 0u);
  // The foci are where their sectors are, as for a finger that is seen for the first time. Only w1 may differ.
  for (const Focus& focus : later.foci) {
    float nearest = 1;
    for (const Focus& other : alone.foci)
      nearest = std::min(nearest, glm::distance(focus.position, other.position));
    EXPECT_LT(nearest, 2.2e-3F);
  }
}

TEST(Glide, CovarianceAndNoSmoothingAreEachFrameByItself) {
  Stream stream(object("prism"), setting_of(10, Smoothing::none, Axes::covariance));
  for (int k = 0; k < 20; ++k) {
    const auto skin = fingertip(2000, 3e-3, 0, 1e-4 * k, static_cast<unsigned>(k));
    const Touch followed = stream.frame(skin, k * frame_90);
    expect_identical(followed, touch_on(Backend::cpu, skin, object("prism"), {.finger_gap_m = 0.02}));
  }
}

}  // namespace
}  // namespace palpa::touch::test
