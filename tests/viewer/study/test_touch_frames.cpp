// The frames of a touch: which had skin over the object, and which of these were thinned, outdated or left out.
#include <gtest/gtest.h>

#include <memory>

#include "session/forward_clock.hpp"
#include "study/sitting/sitting.hpp"
#include "viewer/live/heard_link.hpp"
#include "viewer/study/gate.hpp"
#include "viewer/study/touch_frames.hpp"

namespace palpa::viewer {
namespace {

/// Frames come every 10 ms, with numbers that ascend, and may sound for 100 ms.
class TouchFramesTest : public testing::Test {
 protected:
  TouchFramesTest() {
    array::Voice& voice = schedule_.add_voice();
    voice.foci = {{0, 0, 0.1}};
    voice.order = {0};
    gate_.open(gate_.now() + std::chrono::hours(1));
  }

  void comes() {
    clock_.forward(0.01);
    frames_.arrived(++sequence_);
  }
  session::Plan planned(bool thinned = false, bool outdated = false, bool finger = true) {
    session::FrameReport report{.sequence = sequence_};
    report.effort.pixel_stride = thinned ? 2 : 1;
    report.outdated = outdated;
    session::Plan plan;
    if (finger) plan.schedule = schedule_;
    plan.schedule.time_s = static_cast<double>(sequence_);
    frames_.planned(report, plan);
    return plan;
  }
  /// The frame's plan and its first drives leave.
  void plays(const session::Plan& plan, float amplitude = 1) {
    link_.plan({.schedule = plan.schedule, .slots = {.from = slot_, .until = slot_ + 70}});
    drive_[0].amplitude = amplitude;
    for (int i = 0; i < 7; ++i)
      link_.send(slot_++, drive_);
  }
  void is_felt() {
    comes();
    plays(planned());
  }
  void sees(bool over = true, bool deep = false) { frames_.seen(sequence_, over, deep); }
  /// All frames so far are judged.
  FrameCounts judged() {
    clock_.forward(0.2);
    frames_.end();
    return frames_.counts();
  }

  test::ForwardClock clock_{false};
  Gate gate_{clock_};
  TouchFrames& frames_ = gate_.frames();
  std::shared_ptr<test::HeardSound> heard_ = std::make_shared<test::HeardSound>();
  GateLink link_{std::make_unique<test::HeardLink>(heard_), gate_};
  array::Schedule schedule_;
  array::Drive drive_{2};
  std::uint64_t sequence_ = 0, slot_ = 0;
};

TEST_F(TouchFramesTest, FramesThatAreFeltLackNothing) {
  is_felt();
  frames_.begin(0.1);
  sees();
  for (int i = 0; i < 50; ++i)
    is_felt();
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 50})) << "without the frame before the touch";
  is_felt();
  EXPECT_EQ(frames_.counts().skin, 50u) << "nor those after it";
}

TEST_F(TouchFramesTest, EachFrameIsLostInOneWayOnly) {
  frames_.begin(0.1);
  is_felt();
  comes();  // a newer frame takes its place
  comes();
  planned();  // and the plan of this one is replaced before a drive of it is sent
  comes();
  plays(planned(true));
  comes();
  plays(planned(true, true, false));
  comes();
  plays(planned(false, true, false));
  comes();
  plays(planned(false, false, false));  // no finger in it: nothing is to be felt
  comes();
  plays(planned(), 0);  // between the crests of a modulation
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 8, .thinned = 1, .outdated = 2, .left_out = 2}));
}

/// A link that drops drives on order.
TEST_F(TouchFramesTest, AFrameOfWhichNoDriveArrivesIsLeftOut) {
  frames_.begin(0.1);
  for (int i = 0; i < 40; ++i) {
    heard_->swallows = i % 8 == 5;
    heard_->halves = i % 8 == 2;  // some of its drives arrive
    is_felt();
  }
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 40, .left_out = 5}));
}

TEST_F(TouchFramesTest, WhatAClosedGateWithholdsIsLeftOut) {
  frames_.begin(0.1);
  is_felt();
  gate_.close();
  is_felt();
  is_felt();
  gate_.open(gate_.now() + std::chrono::hours(1));
  link_.send(slot_++, drive_);  // the newest plan sounds from here on
  is_felt();
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 4, .left_out = 1}));
}

TEST_F(TouchFramesTest, OnlyFramesWithSkinOverTheObjectCount) {
  frames_.begin(0.1);
  const auto lose = [&](int frames) {
    for (int i = 0; i < frames; ++i)
      comes();
  };
  sees(false);
  lose(5);
  sees(false);
  lose(3);
  sees();  // that of the third frame; when the skin came is not known
  lose(4);
  sees();
  lose(6);
  sees(true, true);  // too deep: nothing is to be played
  lose(2);
  sees(true, true);
  lose(1);
  sees();
  lose(2);
  EXPECT_EQ(judged(), (FrameCounts{.skin = 8, .left_out = 8})) << "1 and 4, and 1 and 2 at the end";
}

TEST_F(TouchFramesTest, FramesAreJudgedWhenTheyCanSoundNoLonger) {
  frames_.begin(0.1);
  sees();
  for (int i = 0; i < 30; ++i)
    comes();
  sees();
  comes();
  const std::uint64_t judged_so_far = frames_.counts().left_out;
  EXPECT_GE(judged_so_far, 20u);
  EXPECT_LE(judged_so_far, 22u);
  frames_.end();
  EXPECT_EQ(frames_.counts().left_out, judged_so_far) << "the newest ones could still have sounded";
}

/// A source that is read too late gives the newest frame, as cameras do.
TEST_F(TouchFramesTest, FramesThatNeverCameAreLeftOut) {
  is_felt();
  is_felt();
  frames_.begin(0.1);
  sees();
  is_felt();
  sequence_ += 4;
  is_felt();
  is_felt();
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 7, .left_out = 4}));
}

/// Such as a camera of which every third frame is used.
TEST_F(TouchFramesTest, ASourceMayCountInItsOwnSteps) {
  const auto comes_in_steps = [&](std::uint64_t steps) {
    sequence_ += 3 * steps - 1;
    is_felt();
  };
  comes_in_steps(1);
  comes_in_steps(1);
  frames_.begin(0.1);
  sees();
  comes_in_steps(1);
  comes_in_steps(3);
  sees();
  EXPECT_EQ(judged(), (FrameCounts{.skin = 4, .left_out = 2}));
  frames_.begin(0.1);
  sequence_ = 0;  // it was opened again, and counts by ones
  is_felt();
  is_felt();
  is_felt();
  frames_.seen(1000, true, false);
  EXPECT_EQ(judged(), (FrameCounts{.skin = 3}));
}

TEST(LacksStimulus, WithMoreThanATenthOfItsFrames) {
  using study::lacks_stimulus;
  EXPECT_FALSE(lacks_stimulus({}));
  EXPECT_FALSE(lacks_stimulus({.drives = 1000, .skipped_drives = 1000, .skin_frames = 1}));
  EXPECT_FALSE(lacks_stimulus({.outdated_frames = 3, .thinned_frames = 3, .left_out_frames = 4, .skin_frames = 100}));
  EXPECT_TRUE(lacks_stimulus({.outdated_frames = 3, .thinned_frames = 4, .left_out_frames = 4, .skin_frames = 100}));
  EXPECT_TRUE(lacks_stimulus({.thinned_frames = 1, .skin_frames = 9}));
  EXPECT_FALSE(lacks_stimulus({.thinned_frames = 1, .skin_frames = 10}));
}

}  // namespace
}  // namespace palpa::viewer
