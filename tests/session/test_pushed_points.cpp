// A run of points that are pushed.
#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "fakes.hpp"
#include "session/pushed_points.hpp"
#include "session/session.hpp"
#include "stepped_clock.hpp"
#include "support/thrown.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

/// The finger model with its tip at this height.
std::vector<sensing::SkinPoint> pushed_finger(double y) {
  return sensing::numbered(test::finger_at({0, y, 0}));
}

struct PointsRun {
  test::SteppedClock clock;
  Session session;
  PushedPoints source{clock};
  test::SpyLink link;
  std::atomic<bool> stop{false};
  std::vector<EventKind> kinds;
  std::vector<std::uint32_t> fingers;
  test::Watcher watcher;

  /// A finger touches in the first frame.
  PointsRun()
      : session({.solids = test::asset_solids("cube"), .pushed = true, .layout = test::small_layout(), .hold_s = 0.1}) {
    source.push(pushed_finger(-0.001), 0);
    watcher.on_events = [this](std::span<const Event> events) {
      for (const Event& event : events)
        kinds.push_back(event.kind);
    };
  }
  void expect_touch_and_release() const {
    ASSERT_GE(kinds.size(), 2U);
    EXPECT_EQ(kinds.front(), EventKind::touch);
    EXPECT_EQ(kinds.back(), EventKind::release);
    EXPECT_TRUE(link.ended_silent());
  }
  /// The finger touches in the next frame, too, and then no longer.
  LoopStats play(std::uint64_t frames) {
    watcher.on_planned = [&](const FrameReport& frame, const Plan&) {
      fingers.push_back(frame.touch->finger_count);
      clock.sleep(0.01);  // the plan before sounds
      if (fingers.size() < 3) source.push(pushed_finger(fingers.size() == 1 ? -0.001 : 0.01), 0.01);
    };
    return run({.frames = frames, .observer = &watcher});
  }
  LoopStats run(const RunOptions& options) { return session.run(source, link, stop, options, clock); }
};

TEST(PushedPoints, PlaysWhatIsPushedAndEndsInSilence) {
  PointsRun run;
  const LoopStats stats = run.play(3);
  EXPECT_EQ(stats.captured, 3U);
  EXPECT_EQ(stats.touching, 2U);
  EXPECT_EQ(run.fingers, (std::vector<std::uint32_t>{1, 1, 0}));
  EXPECT_GT(run.link.most, 0.0F);
  EXPECT_TRUE(run.link.finished);
  run.expect_touch_and_release();
}

TEST(PushedPoints, EndsWithTheErrorOfItsLink) {
  PointsRun run;
  run.link.fail_at = 0;
  EXPECT_ERROR(run.play(3), Exit::failed, "spy: the link broke");
  EXPECT_TRUE(run.stop);
}

TEST(PushedPoints, ReleasesAFingerWhenNoFrameComes) {
  PointsRun run;
  int expired = 0;
  run.watcher.on_events = [&run, keep = run.watcher.on_events](std::span<const Event> events) {
    keep(events);
    if (!run.kinds.empty() && run.kinds.back() == EventKind::release) run.stop = true;
  };
  run.watcher.on_expired = [&] { ++expired; };
  run.run({.observer = &run.watcher});
  run.expect_touch_and_release();
  EXPECT_EQ(expired, 1);
}

TEST(PushedPoints, TheNewestFrameWins) {
  PushedPoints source;
  EXPECT_FALSE(source.push(sensing::numbered(std::vector<glm::vec3>{{0, 0, 0}}), 1));
  EXPECT_TRUE(source.push(sensing::numbered(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}}), 2));
  sensing::FrameSet frame;
  EXPECT_TRUE(source.next(frame, 0));
  EXPECT_TRUE(frame.came());
  EXPECT_EQ(frame.points.size(), 2U);
  EXPECT_EQ(frame.time_s, 2);
  EXPECT_EQ(frame.sequence, 1U);
  EXPECT_TRUE(source.next(frame, 0.001));
  EXPECT_FALSE(frame.came());
}

TEST(PushedPoints, NeedASessionThatIsPushedTo) {
  PointsRun run;
  Session session({.solids = test::asset_solids("cube"), .layout = test::small_layout()});
  EXPECT_ERROR(session.run(run.source, run.link, run.stop), Exit::usage, "without a source of skin");
}

}  // namespace
}  // namespace palpa::session
