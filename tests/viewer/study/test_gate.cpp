// The gate between a live session and the array.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string_view>
#include <vector>

#include "base/files/sha256.hpp"
#include "session/forward_clock.hpp"
#include "support/thrown.hpp"
#include "viewer/live/heard_link.hpp"
#include "viewer/study/conductor.hpp"
#include "viewer/study/gate.hpp"

namespace palpa::viewer {
namespace {

using namespace std::chrono_literals;

/// Everything that a link got, in order.
struct Told {
  std::vector<std::uint32_t> voices;  ///< of each plan
  std::vector<bool> sounds;           ///< of each drive
};

class ToldLink final : public session::Link {
 public:
  explicit ToldLink(Told& told) : told_(told) {}
  void plan(const session::PlayedPlan& plan) override { told_.voices.push_back(plan.schedule.voice_count); }
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override {
    told_.sounds.push_back(drive[0].amplitude > 0);
  }

 private:
  Told& told_;
};

class GateTest : public testing::Test {
 protected:
  GateTest() {
    array::Voice& voice = schedule_.add_voice();
    voice.foci = {{0, 0, 0.1}};
    voice.order = {0};
    drive_[0].amplitude = 1;
  }
  void plan(std::uint64_t from) { link_.plan({.schedule = schedule_, .slots = {.from = from, .until = from + 10}}); }
  void send(std::uint64_t slot, float amplitude = 0.5F) {
    drive_[0].amplitude = amplitude;
    link_.send(slot, drive_);
  }
  Gate::Clock::time_point later() const { return gate_.now() + 1h; }

  test::ForwardClock clock_{false};
  Gate gate_{clock_};
  Told told_;
  GateLink link_{std::make_unique<ToldLink>(told_), gate_};
  std::shared_ptr<test::HeardSound> heard_ = std::make_shared<test::HeardSound>();
  GateLink counting_{std::make_unique<test::HeardLink>(heard_), gate_};  ///< whose link counts what arrives
  array::Schedule schedule_;
  array::Drive drive_{2};
};

TEST_F(GateTest, IsClosedAtFirstAndClosesForAPlanThatABoardPlaysByItself) {
  plan(0);
  send(0);
  EXPECT_EQ(told_.voices, std::vector<std::uint32_t>{0});
  EXPECT_EQ(told_.sounds, std::vector<bool>{false});
  EXPECT_FALSE(gate_.sounding());
  EXPECT_EQ(gate_.take().counts.drives, 0u);
  gate_.open(later());
  plan(7);
  send(7);
  EXPECT_TRUE(gate_.sounding());
  gate_.close();
  send(8);
  send(9);
  EXPECT_EQ(told_.voices, (std::vector<std::uint32_t>{0, 1, 0})) << "once, before the first silent drive";
  EXPECT_EQ(told_.sounds, (std::vector<bool>{false, true, false, false}));
}

/// A thread that stands still does not renew the moment.
TEST_F(GateTest, ClosesByItself) {
  plan(0);
  gate_.open(gate_.now() + 500ms);
  send(0);
  clock_.forward(0.51);
  send(1);
  EXPECT_EQ(told_.sounds, (std::vector<bool>{true, false}));
  EXPECT_EQ(told_.voices.back(), 0u);
}

TEST_F(GateTest, MeasuresForHowLongItSounds) {
  plan(0);
  send(0);
  clock_.forward(0.02);
  EXPECT_EQ(gate_.sounded_for(), Gate::Clock::duration(0)) << "it was closed";
  gate_.open(later());
  send(1);
  clock_.forward(0.02);
  EXPECT_EQ(gate_.sounded_for(), 20ms) << "the array keeps the drive";
  send(2);
  clock_.forward(0.02);
  send(3, 0);
  EXPECT_EQ(gate_.sounded_for(), 40ms);
  clock_.forward(0.005);
  EXPECT_EQ(gate_.sounded_for(), 40ms) << "the last drive was silent";
  send(4);
  gate_.close();
  clock_.forward(0.005);
  send(5);
  EXPECT_EQ(gate_.sounded_for(), 45ms) << "until silence was sent";
  clock_.forward(0.005);
  EXPECT_EQ(gate_.sounded_for(), 45ms);
}

TEST_F(GateTest, ALinkThatIsGoneSoundsNoLonger) {
  gate_.open(later());
  {
    GateLink link(std::make_unique<ToldLink>(told_), gate_);
    link.send(0, drive_);
    clock_.forward(0.005);
  }
  clock_.forward(0.005);
  EXPECT_EQ(gate_.sounded_for(), 5ms);
}

TEST_F(GateTest, KeepsWhatWasPlayed) {
  plan(0);
  send(0);
  gate_.forget();
  gate_.open(later());
  send(1, 0.25F);
  plan(2);
  send(2, 0);
  gate_.close();
  send(3);
  const PlayedTouch played = gate_.take();
  EXPECT_EQ(played.counts.drives, 2u);
  ASSERT_EQ(played.frames.size(), 3u) << "the plan under way when the gate opened, the next one, and silence";
  EXPECT_EQ(played.frames[0].from, 1u) << "from here on it sounds";
  EXPECT_EQ(played.frames[1].from, 2u);
  EXPECT_EQ(played.frames[1].schedule.voices[0].foci, schedule_.voices[0].foci);
  EXPECT_EQ(played.frames[2].from, 3u);
  EXPECT_EQ(played.frames[2].schedule.voice_count, 0u);
  EXPECT_EQ(played.end, 3u);
  const float floats[] = {0.25F, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(played.drives_sha256, sha256({reinterpret_cast<const char*>(floats), sizeof floats}));
  EXPECT_EQ(gate_.take().counts.drives, 0u) << "taken";
}

TEST_F(GateTest, ATouchDoesNotEndBeforeItsLastFrame) {
  gate_.open(later());
  counting_.send(7, drive_);
  counting_.plan({.schedule = schedule_, .slots = {.from = 20, .until = 30}});
  gate_.close();
  const PlayedTouch played = gate_.take();
  EXPECT_EQ(played.counts.drives, 1u);
  ASSERT_FALSE(played.frames.empty());
  EXPECT_EQ(played.frames.back().from, 20u);
  EXPECT_EQ(played.end, 20u);
}

/// A run warns of drives that were lost on their way, but these were not to arrive.
TEST_F(GateTest, WhatItWithholdsIsNotLost) {
  counting_.plan({.schedule = schedule_, .slots = {.from = 0, .until = 10}});
  counting_.send(0, drive_);
  counting_.send(1, drive_);
  gate_.open(later());
  counting_.send(2, drive_);
  EXPECT_EQ(heard_->sounding, 1u);
  ASSERT_TRUE(counting_.carried());
  EXPECT_EQ(counting_.carried()->completed.drives, 3u);
  EXPECT_EQ(counting_.carried()->submitted.drives, 3u);
}

TEST_F(GateTest, KnowsForHowLongNothingArrives) {
  gate_.open(later());
  counting_.send(0, drive_);
  EXPECT_EQ(gate_.unheard(), 0ns) << "it has arrived";
  heard_->swallows = true;
  for (const auto expected : {0ms, 50ms, 100ms}) {
    counting_.send(1, drive_);
    EXPECT_EQ(gate_.unheard(), expected);
    clock_.forward(0.05);
  }
  clock_.forward(0.06);
  EXPECT_EQ(gate_.unheard(), 0ns) << "nothing has sounded for long";
  heard_->swallows = false;
  counting_.send(2, drive_);
  EXPECT_EQ(gate_.unheard(), 0ns);
  heard_->swallows = true;
  counting_.send(3, drive_);
  gate_.close();
  counting_.send(4, drive_);
  clock_.forward(0.05);
  EXPECT_EQ(gate_.unheard(), 0ns) << "nothing is to arrive";
  // A link that does not count.
  gate_.open(later());
  send(0);
  send(1);
  clock_.forward(0.05);
  EXPECT_EQ(gate_.unheard(), 0ns);
}

/// Silence that is not known to have arrived is not told as silence.
TEST_F(GateTest, KnowsWhetherTheArrayMaySoundOn) {
  heard_->gone = true;
  counting_.send(0, drive_);
  EXPECT_FALSE(gate_.may_sound()) << "nothing has sounded";
  EXPECT_TRUE(gate_.out_of_reach());
  heard_->gone = false;
  gate_.open(later());
  counting_.send(1, drive_);
  EXPECT_FALSE(gate_.may_sound()) << "it sounds";
  heard_->gone = true;
  counting_.send(2, drive_);
  EXPECT_TRUE(gate_.may_sound()) << "the link knows it at once";
  gate_.close();
  counting_.send(3, drive_);
  EXPECT_TRUE(gate_.may_sound()) << "silence does not arrive";
  heard_->gone = false;
  counting_.send(4, drive_);
  EXPECT_FALSE(gate_.may_sound()) << "the link silenced it when it was back";

  gate_.open(later());
  heard_->swallows = true;  // the link does not know
  counting_.send(5, drive_);
  clock_.forward(0.1);
  counting_.send(5, drive_);
  EXPECT_FALSE(gate_.may_sound());
  clock_.forward(0.01);
  EXPECT_TRUE(gate_.may_sound());
  gate_.doubt();
  gate_.close();
  counting_.send(6, drive_);
  EXPECT_TRUE(gate_.may_sound()) << "nor whether the silence has arrived";
  heard_->swallows = false;
  gate_.open(later());
  counting_.send(7, drive_);
  EXPECT_FALSE(gate_.may_sound());

  heard_->unsure = true;
  EXPECT_ERROR(counting_.finish(), Exit::failed, "the last silence");
  EXPECT_TRUE(gate_.may_sound());
  heard_->unsure = false;
  GateLink again(std::make_unique<test::HeardLink>(heard_), gate_);
  EXPECT_FALSE(gate_.may_sound()) << "its link has silenced it";
  again.send(8, drive_);
  heard_->breaks = true;
  EXPECT_ERROR(again.send(9, drive_), Exit::failed, "broken");
  again.finish();
  EXPECT_TRUE(gate_.may_sound());
}

/// What is handed over is not what the array gets.
TEST_F(GateTest, CountsWhatArrives) {
  gate_.open(later());
  heard_->swallows = true;
  for (std::uint64_t slot = 0; slot < 8; ++slot)
    counting_.send(slot, drive_);
  EXPECT_TRUE(gate_.sounding());
  EXPECT_FALSE(gate_.heard()) << "nothing has arrived";
  EXPECT_FALSE(gate_.counts().too_few()) << "a few may be on their way";
  heard_->swallows = false;
  for (std::uint64_t slot = 10; slot < 102; ++slot)  // two slots were slept through
    counting_.send(slot, drive_);
  EXPECT_TRUE(gate_.heard());
  EXPECT_EQ(gate_.counts().sounding, 100u);
  EXPECT_EQ(gate_.counts().arrived, 92u);
  EXPECT_EQ(gate_.counts().lost(), 8u);
  EXPECT_EQ(gate_.counts().skipped, 2u);
  heard_->swallows = true;
  counting_.send(102, drive_);
  EXPECT_FALSE(gate_.counts().too_few()) << "1 %, and 8 that silence may overtake";
  counting_.send(103, drive_);
  EXPECT_TRUE(gate_.counts().too_few());
  heard_->arrived += 2;
  gate_.close();
  counting_.send(104, drive_);
  EXPECT_EQ(gate_.take().counts.lost(), 8u) << "those on their way count when they arrive";
  gate_.open(later());
  counting_.send(5000, drive_);
  counting_.send(5001, drive_);
  EXPECT_EQ(gate_.counts().skipped, 0u) << "the pause before a touch does not count";
}

TEST_F(GateTest, KnowsTheFrameOfTheNewestPlan) {
  EXPECT_LT(gate_.newest_s(), 0);
  schedule_.time_s = 3.5;
  plan(0);
  EXPECT_EQ(gate_.newest_s(), 3.5) << "also while it is closed";
  gate_.restart();
  EXPECT_LT(gate_.newest_s(), 0);
}

TEST(StudyLosses, AreToldEachByItsNumber) {
  EXPECT_EQ(
      to_text({.drives = 1, .skipped_drives = 2, .outdated_frames = 3, .thinned_frames = 4, .left_out_frames = 5}),
      "1 drive lost, 2 drives never sent, 3 frames too late, 4 frames thinned, 5 frames left out");
  EXPECT_EQ(to_text({.thinned_frames = 1}), "1 frame thinned");
  EXPECT_EQ(to_text({}), "");
}

}  // namespace
}  // namespace palpa::viewer
