// Recordings of hands at rest: the number of fingers and where their foci are do not change from frame to frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "sensing/recording.hpp"
#include "support/shared_data.hpp"
#include "touch/stage.hpp"

namespace palpa::touch::test {
namespace {

struct Played {
  std::vector<std::uint32_t> fingers;  ///< per frame
  std::vector<double> steps_m;         ///< of each focus from frame to frame

  double most_step_m() const { return steps_m.empty() ? 0 : *std::ranges::max_element(steps_m); }
};

/// Lists the steps of the foci that a finger has in both frames.
void compare(const Touch& before, const Touch& now, Played& out) {
  for (std::uint32_t f = 0; f < now.finger_count; ++f) {
    const Finger& finger = now.fingers[f];
    const auto known = std::span(before.fingers).first(before.finger_count);
    const auto old = std::ranges::find(known, finger.id, &Finger::id);
    if (old == known.end() || old->foci.size() != finger.foci.size()) continue;
    for (std::size_t n = 0; n < finger.foci.size(); ++n)
      out.steps_m.push_back(glm::distance(finger.foci[n].position, old->foci[n].position));
  }
}

Played play(const std::filesystem::path& folder, const std::filesystem::path& scene) {
  const sensing::Recording recording = sensing::load_recording(folder);
  Stage stage(geometry::make_solids(geometry::load_gltf(scene)), recording.cameras,
              {.follow = true, .hysteresis = Hysteresis::on});
  Played played;
  Touch before, now;
  sensing::FrameSet set;
  for (std::size_t k = 0; k < recording.entries.size(); ++k) {
    read_entry(recording, k, set);
    stage.touch(set.frames, now, recording.entries[k].time_s);
    played.fingers.push_back(now.finger_count);
    if (k > 0) compare(before, now, played);
    before = now;
  }
  return played;
}

TEST(RecordedHands, HaveAsManyFingersInEachFrameAsTheyTouchWith) {
  PALPA_SHARED_OR_SKIP(folder, "hands-more");
  struct Hand {
    const char *name, *scene;
    std::uint32_t fingers;
    double most_step_m;
  };
  for (const Hand& hand : {
           Hand{"through-10mm-one-camera", "plate-10.glb", 1, 1.2e-3},
           Hand{"through-10mm-leaning-three-cameras", "plate-10.glb", 1, 1e-3},
           Hand{"ring-of-a-half-sunk-finger", "plate-60.glb", 1, 1.5e-3},
       }) {
    const Played played = play(folder / hand.name, folder / hand.scene);
    EXPECT_EQ(played.fingers, std::vector<std::uint32_t>(played.fingers.size(), hand.fingers)) << hand.name;
    EXPECT_LE(played.most_step_m(), hand.most_step_m) << hand.name;
  }
}

TEST(RecordedHands, AFarHandHasFiveFingersAfterATenthOfASecond) {
  PALPA_SHARED_OR_SKIP(folder, "hands-more");
  const Played played = play(folder / "far-hand-one-camera", folder / "bigbox.glb");
  constexpr std::size_t begin = 9;  // at 90 Hz
  ASSERT_EQ(played.fingers.size(), 2 * begin);
  EXPECT_EQ(std::vector(played.fingers.begin() + begin, played.fingers.end()), std::vector<std::uint32_t>(begin, 5));
}

TEST(RecordedHands, TheBackOfAHandStaysOneFinger) {
  PALPA_SHARED_OR_SKIP(folder, "hands-unsteady");
  const Played played = play(folder / "palm-back-thin", folder / "plate-2.glb");
  EXPECT_EQ(played.fingers, std::vector<std::uint32_t>(played.fingers.size(), 1));
  EXPECT_LE(played.most_step_m(), 2e-3);
}

}  // namespace
}  // namespace palpa::touch::test
