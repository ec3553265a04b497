// Gliding foci with unusual frame times and other fingers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>

#include "touch/fingers/glide_stream.hpp"
#include "touch/fingertips.hpp"

namespace palpa::touch::test {
namespace {

TEST(GlideOn, AFingerThatWasInAnothersClusterRestartsEvenIfItWasLostInBetween) {
  const auto skin_at = [](double a, double b) {
    std::vector<glm::vec3> skin = fingertip(1500, 3e-3, a, 0, 1);
    const std::vector<glm::vec3> other = fingertip(1500, 3e-3, b, 0, 2);
    skin.insert(skin.end(), other.begin(), other.end());
    return skin;
  };
  StageSetting smooth = setting_of(10, Smoothing::one_euro), plain = setting_of(10, Smoothing::none);
  smooth.parameters.finger_gap_m = plain.parameters.finger_gap_m = 5e-3;
  Stream stream({cube()}, smooth), raw({cube()}, plain);
  int k = 0;
  const auto frame = [&](const std::vector<glm::vec3>& skin) {
    raw.frame(skin, k * frame_90);
    return stream.frame(skin, k++ * frame_90);
  };
  for (double apart = 0.030; apart > 0.009; apart -= 1.5e-3)
    frame(skin_at(-0.018, -0.018 + apart));
  Touch touch;
  for (double x = -0.018; x < 0; x += 2e-3)
    touch = frame(skin_at(x, x + 9e-3));
  ASSERT_EQ(touch.finger_count, 1u);
  const std::uint32_t leader = touch.fingers[0].id;
  frame({});
  const std::vector<glm::vec3> parted = skin_at(-0.008, 0.014);
  const Touch expected = raw.frame(parted, k * frame_90);
  touch = stream.frame(parted, k * frame_90);
  ASSERT_EQ(touch.finger_count, 2u);
  std::vector<std::uint32_t> ids;
  for (std::size_t f = 0; f < 2; ++f) {
    ids.push_back(touch.fingers[f].id);
    if (touch.fingers[f].id == leader) continue;  // its foci were the cluster's and go on
    for (std::size_t n = 0; n < 10; ++n) {
      if (touch.fingers[f].foci[n].points == 0) continue;
      EXPECT_EQ(touch.fingers[f].foci[n].position, expected.fingers[f].foci[n].position) << n;
    }
  }
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{0, 1}));
}

/// Mean way from where foci are to where their sectors have them.
Vec3 mean_lag(const Finger& finger, const Finger& raw) {
  Vec3 lag(0);
  double count = 0;
  for (std::size_t n = 0; n < raw.foci.size(); ++n) {
    if (raw.foci[n].points == 0) continue;
    lag += Vec3(raw.foci[n].position - finger.foci[n].position);
    ++count;
  }
  return lag / count;
}

TEST(GlideOn, WhereTimesStandStillOrStutterFociKeepUpWithTheFinger) {
  // 1.1 mm per frame: 100 mm/s at 90 Hz, whatever the times say.
  const auto stuttering = [](int k) { return k / 2 * 0.022; };
  const auto standing = [](int) { return 5.0; };
  for (const auto& time_of : {std::function<double(int)>(stuttering), std::function<double(int)>(standing)}) {
    Stream stream({cube()}, setting_of(10, Smoothing::one_euro));
    Stream raw({cube()}, setting_of(10, Smoothing::none));
    for (int k = 0; k < 30; ++k) {
      const auto skin = fingertip(1500, 3e-3, -0.016 + 1.1e-3 * k, 0, 1);
      const Finger finger = stream.frame(skin, time_of(k)).fingers.at(0);
      EXPECT_LT(glm::length(mean_lag(finger, raw.frame(skin, time_of(k)).fingers.at(0))), 1.1e-3) << k;
      EXPECT_EQ(finger.id, 0u);
    }
  }
}

TEST(GlideOn, WhileTimeStandsStillAFocusFarFromItsSectorRestarts) {
  const auto ring = [](double radius) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 720; ++i) {
      const double angle = i * std::numbers::pi / 360;
      points.emplace_back(radius * std::cos(angle), -0.5e-3, radius * std::sin(angle));
    }
    return points;
  };
  Stream stream({cube()}, setting_of(10, Smoothing::one_euro));
  stream.frame(ring(4e-3), 1);
  const auto radius = [&](double of_skin) {
    double most = 0;
    for (const Focus& focus : stream.frame(ring(of_skin), 1).fingers.at(0).foci)
      most = std::max<double>(most, glm::length(glm::vec2(focus.position.x, focus.position.z)));
    return most;
  };
  EXPECT_NEAR(radius(12e-3), 4e-3, 0.2e-3) << "8 mm off: nothing is filtered";
  EXPECT_NEAR(radius(15e-3), 15e-3, 0.4e-3);
}

TEST(GlideOn, GoesOnBelowTenFramesPerSecond) {
  Stream stream({cube()}, setting_of(10, Smoothing::one_euro));
  Stream raw({cube()}, setting_of(10, Smoothing::none));
  std::vector<double> with, without;
  std::optional<Finger> before, raw_before;
  for (int k = 0; k < 40; ++k) {
    const auto skin = fingertip(400, 3e-3, 0, 0, static_cast<unsigned>(k));
    const Finger now = stream.frame(skin, k / 8.0).fingers.at(0), raw_now = raw.frame(skin, k / 8.0).fingers.at(0);
    if (before) {
      with.push_back(step_between(*before, now));
      without.push_back(step_between(*raw_before, raw_now));
    }
    before = now;
    raw_before = raw_now;
  }
  const auto mean = [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  };
  EXPECT_LT(mean(with), 0.9 * mean(without));
}

}  // namespace
}  // namespace palpa::touch::test
