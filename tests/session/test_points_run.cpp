// A session live from points that are pushed.
#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "fakes.hpp"
#include "geometry/gltf/gltf.hpp"
#include "session/points_run.hpp"
#include "support/begins.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

std::vector<geometry::Solid> touchable_cube() {
  return geometry::make_solids(geometry::load_gltf(test::source_file("assets/cube.glb")));
}

/// The finger model with its tip at this height.
std::vector<glm::vec3> pushed_finger(double y) {
  std::vector<glm::vec3> points;
  for (const Vec3& p : test::finger_skin().mesh.positions)
    points.emplace_back(p + Vec3(0, y, 0));
  return points;
}

struct PointsPlay {
  Session session;
  PushedPoints source;
  test::SpyLink link;
  std::atomic<bool> stop{false};
  std::vector<EventKind> kinds;
  std::vector<std::uint32_t> fingers;

  /// With this hold, a frame sounds however slow the machine is.
  explicit PointsPlay(double hold_s = 60)
      : session({.solids = touchable_cube(), .layout = test::small_layout(), .hold_s = hold_s}) {}

  LoopStats play(std::uint64_t frames) {
    test::Watcher watcher;
    watcher.on_events = [&](std::span<const Event> events) {
      for (const Event& event : events)
        kinds.push_back(event.kind);
    };
    watcher.on_planned = [&](const FrameReport& frame, const Plan&) {
      fingers.push_back(frame.touch->finger_count);
      if (frame.touch->finger_count > 0 && fingers.size() > 1) {
        EXPECT_TRUE(test::begins([&] { return link.most > 0 || stop; }));
      }
      if (fingers.size() < 3) source.push(pushed_finger(fingers.size() == 1 ? -0.001 : 0.01), 0.01);
    };
    return run_points(session, source, link, stop, {.frames = frames, .observer = &watcher});
  }
};

TEST(PointsRun, PlaysWhatIsPushedAndEndsInSilence) {
  PointsPlay run;
  run.source.push(pushed_finger(-0.001), 0);
  const LoopStats stats = run.play(3);
  EXPECT_EQ(stats.captured, 3U);
  EXPECT_EQ(stats.touching, 2U);
  EXPECT_EQ(run.fingers, (std::vector<std::uint32_t>{1, 1, 0}));
  EXPECT_GT(run.link.most, 0.0F);
  EXPECT_TRUE(run.link.ended_silent());
  EXPECT_TRUE(run.link.finished);
  ASSERT_FALSE(run.kinds.empty());
  EXPECT_EQ(run.kinds.front(), EventKind::touch);
  EXPECT_EQ(run.kinds.back(), EventKind::release);
}

TEST(PointsRun, EndsWithTheErrorOfItsLink) {
  PointsPlay run;
  run.link.fail_at = 0;
  EXPECT_ERROR(run.play(3), Exit::failed, "spy: the link broke");
  EXPECT_TRUE(run.stop);
}

TEST(PointsRun, ReleasesAFingerWhenNoFrameComes) {
  PointsPlay run(0.1);
  run.source.push(pushed_finger(-0.001), 0);
  std::vector<EventKind> kinds;
  int expired = 0;
  test::Watcher watcher;
  watcher.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events)
      kinds.push_back(event.kind);
    if (!kinds.empty() && kinds.back() == EventKind::release) run.stop = true;
  };
  watcher.on_expired = [&] { ++expired; };
  run_points(run.session, run.source, run.link, run.stop, {.observer = &watcher});
  ASSERT_GE(kinds.size(), 2U);
  EXPECT_EQ(kinds.front(), EventKind::touch);
  EXPECT_EQ(kinds.back(), EventKind::release);
  EXPECT_EQ(expired, 1);
  EXPECT_TRUE(run.link.ended_silent());
}

TEST(PointsRun, TheNewestFrameWins) {
  PushedPoints source;
  EXPECT_FALSE(source.push({{0, 0, 0}}, 1));
  EXPECT_TRUE(source.push({{0, 0, 0}, {1, 0, 0}}, 2));
  std::vector<glm::vec3> points;
  double time_s = 0;
  EXPECT_TRUE(source.take(points, time_s, 0));
  EXPECT_EQ(points.size(), 2U);
  EXPECT_EQ(time_s, 2);
  EXPECT_FALSE(source.take(points, time_s, 0.001));
}

TEST(PointsRun, IsRefusedWhereItCannotWork) {
  PushedPoints source;
  test::SpyLink link;
  std::atomic<bool> stop{false};
  test::DeafSink sink;
  Session without_array({.solids = touchable_cube()});
  EXPECT_ERROR(run_points(without_array, source, link, stop), Exit::usage, "without an array cannot run from points");
  Session without_events({.solids = touchable_cube(), .layout = test::small_layout(), .events = std::nullopt});
  EXPECT_ERROR(run_points(without_events, source, link, stop, {.events = &sink}), Exit::usage, "has no events");
}

}  // namespace
}  // namespace palpa::session
