// One number for the state that passes from frame to frame, over many frames: ids, steady axes and gliding foci. The
// test matrix compares it between thread counts, vector widths, staging and sanitizers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "base/math.hpp"
#include "support/digest.hpp"
#include "touch/fingers/glide_stream.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::Digest;

/// An oblong fingertip that slides, leans and turns about its own axis, and a second finger that comes and goes beside
/// it. Each frame has a different sample of the skin.
std::vector<glm::vec3> followed_skin(int k) {
  const double t = k * frame_90, turn = 3 * t, lean = 0.3 * std::sin(4 * t);
  const glm::dmat3 turned(Vec3(std::cos(turn), 0, -std::sin(turn)), Vec3(0, 1, 0),
                          Vec3(std::sin(turn), 0, std::cos(turn)));
  const glm::dmat3 leaning(Vec3(1, 0, 0), Vec3(0, std::cos(lean), std::sin(lean)),
                           Vec3(0, -std::sin(lean), std::cos(lean)));
  const Vec3 tip(-0.02 + 0.01 * std::sin(5 * t), -3e-3, 0.01 * std::sin(7 * t));
  std::vector<glm::vec3> skin = fingertip(1500, 0, 0, 0, static_cast<unsigned>(k));
  for (glm::vec3& p : skin)
    p = glm::vec3(tip + leaning * (turned * Vec3(1.5 * p.x, p.y, p.z)));
  if (k % 20 < 4) return skin;
  const auto other = fingertip(800, 2.5e-3, 0.035, 0.02 * t, static_cast<unsigned>(k));
  skin.insert(skin.end(), other.begin(), other.end());
  return skin;
}

void add(Digest& digest, const Finger& finger) {
  digest.add(finger.id);
  digest.add(finger.section.centroid);
  for (int i = 0; i < 3; ++i) {
    digest.add(finger.section.axes[i]);
    digest.add(finger.section.eigenvalues[i]);
  }
  digest.add(finger.section.turn);
  for (const Focus& focus : finger.foci) {
    digest.add(focus.points);
    digest.add(focus.held);
    digest.add(focus.position);
  }
}

std::uint64_t digest_of_frames(int frames) {
  StageSetting setting = setting_of(10, Smoothing::one_euro);
  setting.parameters.finger_gap_m = 0.012;
  DeviceStage stage({box({-0.06, -0.04, -0.05}, {0.06, 0, 0.05})}, {}, setting);
  Touch touch;
  Digest digest;
  std::set<std::uint32_t> ids;
  for (int k = 0; k < frames; ++k) {
    stage.touch(indexed(followed_skin(k)), touch, k * frame_90);
    EXPECT_EQ(touch.finger_count, k % 20 < 4 ? 1U : 2U) << k;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      EXPECT_TRUE(touch.fingers[f].placed) << k;
      ids.insert(touch.fingers[f].id);
      add(digest, touch.fingers[f]);
    }
  }
  EXPECT_EQ(ids, (std::set<std::uint32_t>{0, 1})) << "both fingers keep their ids";
  return digest.value();
}

TEST(FollowedBytes, AreTheSameOnEveryRunAndInEveryLegOfTheMatrix) {
  EXPECT_EQ(digest_of_frames(20), digest_of_frames(20));
  palpa::test::tell_digest("follow", digest_of_frames(60));
}

}  // namespace
}  // namespace palpa::touch::test
