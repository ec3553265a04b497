// Gliding foci with unusual frame times, other fingers, and contacts that join a finger or leave it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "touch/fingers/glide_stream.hpp"

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

TEST(GlideOn, FociStayOnTheirSkinWhenContactsJoinOrLeave) {
  // 96 contacts that slide at 100 mm/s. For 20 frames, there are 48 more, 19 mm beside them.
  const auto skin = [](double way, bool more) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < (more ? 18 : 12) * 8; ++i)
      points.emplace_back(way + 1e-3 * (i / 8 + (i < 96 ? 0 : 18)), -0.5e-3, 1e-3 * (i % 8));
    return points;
  };
  Stream stream({box({-0.15, -0.04, -0.15}, {0.15, 0, 0.15})}, setting_of(10, Smoothing::one_euro));
  const glm::vec3 step(0.1 * frame_90, 0, 0);
  Finger before;
  for (int k = 0; k < 80; ++k) {
    const Touch& touch = stream.frame(skin(k * 0.1 * frame_90, k >= 30 && k < 50), k * frame_90);
    ASSERT_EQ(touch.finger_count, 1u) << k;
    const Finger& finger = touch.fingers[0];
    EXPECT_EQ(finger.id, 0u);
    if (k >= 25) {  // the finger's velocity is known
      const float jump = glm::length(finger.section.centroid - before.section.centroid - step);
      EXPECT_EQ(jump > 8e-3F, k == 30 || k == 50) << k << ": " << jump;
      for (std::size_t n = 0; n < finger.foci.size(); ++n)
        EXPECT_LT(glm::length(finger.foci[n].position - before.foci[n].position - step), 0.09 * frame_90)
            << "frame " << k << " focus " << n;
    }
    before = finger;
  }
}

}  // namespace
}  // namespace palpa::touch::test
