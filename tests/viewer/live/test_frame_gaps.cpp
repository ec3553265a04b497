// Drawing and the computation of touch take turns.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "viewer/live/frame_gaps.hpp"

namespace palpa::viewer {
namespace {

constexpr double every_s = 1.0 / 15, takes_s = 5e-3;

/// After this many frames. The last one arrived at 0 s; frames are planned after 5 ms.
Rhythm after(int frames, double between_s = every_s) {
  Rhythm rhythm;
  for (int i = 0; i < frames; ++i) {
    const double now_s = (i + 1 - frames) * between_s;
    rhythm.arrived(i, now_s);
    if (i + 1 < frames) rhythm.planned(i, now_s + takes_s);
  }
  return rhythm;
}

TEST(FrameGaps, OnlyAFrameUnderWayIsWaitedForAndNotForLong) {
  EXPECT_FALSE(Rhythm().wait_until(3, 1)) << "there are no frames";
  EXPECT_FALSE(after(4).wait_until(0.3, 1e-3)) << "it is never planned";
  Rhythm rhythm = after(1);
  EXPECT_GT(rhythm.wait_until(1e-3, 1e-3).value_or(0), 0.1);
  rhythm.planned(0, takes_s);
  EXPECT_FALSE(rhythm.wait_until(takes_s, 1e-3)) << "when the next comes is not known yet";
}

TEST(FrameGaps, WorkThatWouldNotEndBeforeTheNextFrameWaitsForIt) {
  Rhythm rhythm = after(10);
  rhythm.planned(9, takes_s);
  EXPECT_FALSE(rhythm.wait_until(takes_s, 20e-3));
  EXPECT_FALSE(rhythm.wait_until(every_s - 21e-3, 20e-3));
  const auto until_s = rhythm.wait_until(every_s - 19e-3, 20e-3);
  ASSERT_TRUE(until_s);
  EXPECT_GT(*until_s, every_s);
  EXPECT_FALSE(rhythm.wait_until(*until_s, 20e-3)) << "it does not come";
}

TEST(FrameGaps, FramesThatLeaveLittleTimeLeaveIt) {
  Rhythm rhythm = after(50, 11e-3);
  rhythm.planned(49, takes_s);
  EXPECT_FALSE(rhythm.wait_until(takes_s, 50e-3)) << "there is no better time for slow work";
  EXPECT_TRUE(rhythm.wait_until(8e-3, 50e-3));
}

TEST(FrameGaps, ANewerFrameIsUnderWayWhenAnOlderOneIsPlanned) {
  Rhythm rhythm = after(10);
  rhythm.arrived(10, 3e-3);
  rhythm.planned(9, takes_s);
  EXPECT_TRUE(rhythm.wait_until(6e-3, 1e-3));
  rhythm.planned(10, 9e-3);
  EXPECT_FALSE(rhythm.wait_until(9e-3, 1e-3));
}

TEST(FrameGaps, AFrameThatWasLeftOutDelaysNoOther) {
  Rhythm rhythm = after(20);
  rhythm.planned(19, takes_s);
  rhythm.arrived(21, 2 * every_s);
  rhythm.planned(21, 2 * every_s + takes_s);
  EXPECT_FALSE(rhythm.wait_until(3 * every_s - 10e-3, 8e-3));
  EXPECT_TRUE(rhythm.wait_until(3 * every_s - 6e-3, 8e-3));
}

TEST(FrameGaps, FramesMayBecomeFewer) {
  Rhythm rhythm = after(20);
  for (int i = 0; i < 8; ++i) {
    rhythm.arrived(20 + i, 2 * every_s * (i + 1));
    rhythm.planned(20 + i, 2 * every_s * (i + 1) + takes_s);
  }
  EXPECT_FALSE(rhythm.wait_until(17 * every_s - 6e-3, 8e-3));
  EXPECT_TRUE(rhythm.wait_until(18 * every_s - 6e-3, 8e-3));
}

// A frame that comes late does not make the next one late.
TEST(FrameGaps, TheNextFrameIsDueByThoseThatWereOnTime) {
  Rhythm rhythm = after(20);
  rhythm.planned(19, takes_s);
  rhythm.arrived(20, every_s + 8e-3);
  rhythm.planned(20, every_s + 8e-3 + takes_s);
  EXPECT_FALSE(rhythm.wait_until(2 * every_s - 11e-3, 8e-3));
  EXPECT_TRUE(rhythm.wait_until(2 * every_s - 6e-3, 8e-3));
}

TEST(FrameGaps, WhoWaitsIsWokenWhenTheFrameIsPlanned) {
  using namespace std::chrono_literals;
  // Before the frame would be abandoned.
  const auto in_time = [](double waited_s) { return waited_s < 0.2; };
  for (const bool ends : {false, true}) {
    bool woken = false;
    for (int attempt = 0; attempt < 20 && !woken; ++attempt) {  // this thread must get a chance to run, too
      FrameGaps turns;
      EXPECT_LT(turns.wait(1e-3, 60), 60) << "nothing is under way";
      turns.arrived(0);
      if (turns.wait(1e-3, 0.02) < 0.02) continue;  // it does not wait, or this thread stood still
      std::thread run([&] {
        std::this_thread::sleep_for(20ms);
        ends ? turns.over() : turns.planned(0);
      });
      woken = in_time(turns.wait(1e-3, 60));
      run.join();
    }
    EXPECT_TRUE(woken);
  }
}

struct HandClock : session::Clock {
  double now_s = 0;
  double now() const override { return now_s; }
};

TEST(FrameGaps, APieceIsExpectedToTakeAsLongAsInThePicturesBefore) {
  std::vector<double> works_s, mosts_s;
  HandClock clock;
  PictureSteps pieces(
      [&](double work_s, double most_s) {
        works_s.push_back(work_s);
        mosts_s.push_back(most_s);
        return 0.04;
      },
      clock);
  for (int picture = 0; picture < 3; ++picture) {
    works_s.clear();
    mosts_s.clear();
    pieces.begin();
    pieces.pause();
    pieces.pause();  // after a piece that took no time
    clock.now_s += 5e-3;
    pieces.pause();
    pieces.pause();
    EXPECT_NEAR(pieces.end(), 0.12, 1e-12);
  }
  ASSERT_EQ(works_s.size(), 3u) << "a picture has waited long enough";
  EXPECT_LT(works_s[0], works_s[1]);
  EXPECT_GT(works_s[1], 5e-3);
  EXPECT_NEAR(mosts_s[0], PictureSteps::most_s, 1e-12);
  EXPECT_NEAR(mosts_s[2], PictureSteps::most_s - 0.08, 1e-12);
}

}  // namespace
}  // namespace palpa::viewer
