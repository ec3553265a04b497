#include "touch/fingers/two_fingers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sensing/synthetic.hpp"
#include "support/hand_skin.hpp"
#include "touch/fingertips.hpp"
#include "touch/stage.hpp"

namespace palpa::touch::test {
namespace {

constexpr double press_m = 3e-3;

/// At least 22 mm from the middle, and as far as four frames take: before that the two are seen apart.
double lead(double speed, double rate_hz) {
  return 0.022 + 4 * speed / rate_hz;
}

Transform standing(const Vec3& tip) {
  Transform T(1.0);
  T[3] = Vec4(tip.x, -press_m, tip.z, 1);
  return T;
}

}  // namespace

Walk crossing(double speed, double rate_hz, double aside) {
  const double reach = lead(speed, rate_hz);
  return {2 * reach / speed, [=](double t) {
            const double x = speed * t - reach;
            return std::array{Vec3(x, 0, aside / 2), Vec3(-x, 0, -aside / 2)};
          }};
}

Walk bouncing(double speed, double rate_hz, double hold_s) {
  const double brake = 0.010, nearest = 0.0065;
  const double reach = lead(speed, rate_hz) - nearest - brake;  // at full speed
  const double slow_s = 2 * brake / speed, fast_s = reach / speed;
  const double approach_s = slow_s + fast_s;
  return {2 * approach_s + hold_s, [=](double t) {
            const double left = t < approach_s ? approach_s - t : std::max(0.0, t - approach_s - hold_s);
            const double x =
                nearest + (left < slow_s ? brake * left * left / (slow_s * slow_s) : brake + speed * (left - slow_s));
            return std::array{Vec3(-x, 0, 0.001), Vec3(x, 0, -0.001)};
          }};
}

std::vector<geometry::Solid> plate() {
  return {box({-0.15, -0.04, -0.15}, {0.15, 0, 0.15}, "plate")};
}

std::vector<sensing::FrameSet> film(const Walk& walk, int cameras, double rate_hz, std::uint64_t seed) {
  const geometry::Mesh& finger = palpa::test::finger_skin().mesh;
  sensing::SyntheticRig rig(paper_cameras(cameras), {}, sensing::Noise::d415, seed);
  std::vector<sensing::FrameSet> frames;
  for (std::uint64_t k = 0; static_cast<double>(k) / rate_hz <= walk.seconds; ++k) {
    const double t = static_cast<double>(k) / rate_hz;
    const auto tips = walk.tips(t);
    const std::array<sensing::Posed, 2> skin{sensing::Posed{&finger, standing(tips[0])},
                                             sensing::Posed{&finger, standing(tips[1])}};
    sensing::FrameSet& set = frames.emplace_back();
    rig.render(skin, k, set);
    set.sequence = k;
    set.time_s = t;
    for (sensing::DepthFrame& frame : set.frames)
      frame.time_s = t;
  }
  return frames;
}

std::vector<Sighting> follow(const Walk& walk, const std::vector<sensing::FrameSet>& frames, int cameras) {
  const auto rig = paper_cameras(cameras);
  const auto solids = plate();
  // Clusters as they are, so that fingers do merge: what the pictures say of them would keep some apart.
  const StageSetting setting{.parameters = {.finger_width_m = 0}, .follow = true};
  std::vector<Sighting> sightings;
  const auto note = [&](const Touch& touch, double time_s) {
    const auto tips = walk.tips(time_s);
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      std::array<std::size_t, 2> of{};
      for (const std::uint32_t i : finger.contacts) {
        const Vec3 p(touch.contacts[i].position.x, 0, touch.contacts[i].position.z);
        ++of[glm::distance(p, tips[0]) <= glm::distance(p, tips[1]) ? 0 : 1];
      }
      Sighting& s = sightings.emplace_back();
      s.time_s = time_s;
      s.centroid = finger.section.centroid;
      s.id = finger.id;
      for (int k = 0; k < 2; ++k)
        s.skin[k] = 5 * of[k] >= finger.contacts.size();
    }
  };
  Touch touch;
  Stage stage(solids, rig, setting);
  for (const sensing::FrameSet& set : frames) {
    stage.touch(set.frames, touch, set.time_s);
    note(touch, set.time_s);
  }
  return sightings;
}

}  // namespace palpa::touch::test
