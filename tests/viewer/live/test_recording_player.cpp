// A recording that a user controls.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "sensing/recording.hpp"
#include "support/cameras.hpp"
#include "support/shared_data.hpp"
#include "viewer/live/recording_player.hpp"

namespace palpa::viewer {
namespace {

constexpr std::uint64_t frames = 5;

/// Each frame's first pixel is its number.
std::unique_ptr<sensing::DepthSource> open(RecordingPlayer& player, const char* name) {
  const auto folder = test::scratch_folder(name) / "take";
  sensing::RecordingWriter writer(folder, {test::pinhole("one", 8, 8, 8)});
  for (std::uint64_t i = 0; i < frames; ++i) {
    sensing::FrameSet set;
    set.sequence = i;
    set.time_s = 0.01 * static_cast<double>(i);
    set.frames.push_back({std::vector<std::uint16_t>(64, static_cast<std::uint16_t>(i + 1)), set.time_s});
    writer.write(set);
  }
  const std::vector<sensing::Camera> none;
  return player.source().open(folder.string(), {.cameras = none, .occluders = geometry::Mesh()});
}

/// The number of the next frame; 0 if none comes.
std::uint64_t next(sensing::DepthSource& source, double timeout_s = 5) {
  sensing::FrameSet set;
  if (!source.next(set, timeout_s) || set.frames.empty()) return 0;
  return set.frames.front().depth.front();
}

TEST(RecordingPlayer, PlaysStopsStepsAndGoesWithinItsFrames) {
  RecordingPlayer player;
  EXPECT_FALSE(player.now());
  const auto source = open(player, "viewer-player");
  ASSERT_TRUE(player.now());
  EXPECT_EQ(player.now()->frames, frames);
  EXPECT_NEAR(player.now()->length_s, 0.04, 1e-12);
  EXPECT_EQ(next(*source), 1u);
  Playback seen = *player.now();  // as in the last picture
  EXPECT_EQ(next(*source), 2u);
  EXPECT_EQ(next(*source), 3u);

  seen.playing = false;
  player.play(seen);
  EXPECT_EQ(player.now()->frame, 2u) << "it stops where it is";
  EXPECT_EQ(next(*source, 0.05), 0u) << "it stands still";
  player.step(1);
  EXPECT_EQ(next(*source), 4u);
  player.step(-2);
  EXPECT_EQ(next(*source), 2u);
  EXPECT_EQ(next(*source, 0.05), 0u);
  player.step(-5);
  EXPECT_EQ(next(*source), 1u) << "there is no frame before the first";
  player.step(9);
  EXPECT_EQ(next(*source), frames) << "nor after the last";

  player.go_to(2);
  EXPECT_EQ(next(*source), 3u);
  EXPECT_EQ(player.now()->frame, 2u);
  seen.playing = true;
  player.play(seen);
  EXPECT_EQ(next(*source), 4u) << "it goes on where it is";
}

TEST(RecordingPlayer, TimesAndNumbersGoOnWhereverItIs) {
  RecordingPlayer player;
  const auto source = open(player, "viewer-player-times");
  sensing::FrameSet set;
  double last_s = -1;
  for (std::uint64_t i = 0; i < 2 * frames; ++i) {  // it restarts at its end
    ASSERT_TRUE(source->next(set, 5));
    ASSERT_FALSE(set.frames.empty());
    EXPECT_EQ(set.frames.front().depth.front(), i % frames + 1);
    EXPECT_EQ(set.sequence, i);
    EXPECT_GT(set.time_s, last_s);
    last_s = set.time_s;
  }
  Playback play = *player.now();
  play.loop = false;
  player.play(play);
  EXPECT_FALSE(source->next(set, 5)) << "the end";
}

TEST(RecordingPlayer, WithoutALoopItPlaysToItsLastFrameFromWhereverItIs) {
  RecordingPlayer player;
  const auto source = open(player, "viewer-player-once");
  Playback play = *player.now();
  play.loop = false;
  play.speed = 100;
  player.play(play);
  sensing::FrameSet set;
  for (std::uint64_t from = 0; from < frames; ++from) {
    player.go_to(from);
    for (std::uint64_t i = from; i < frames; ++i)
      EXPECT_EQ(next(*source), i + 1) << "from " << from;
    EXPECT_EQ(player.now()->frame, frames - 1);
    EXPECT_FALSE(source->next(set, 5)) << "the end";
  }
}

}  // namespace
}  // namespace palpa::viewer
