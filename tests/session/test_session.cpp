// A session frame by frame: skin in, fingers, events and a schedule out, on both backends.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/board_mesh.hpp"
#include "array/loudness.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "fakes.hpp"
#include "sensing/synthetic.hpp"
#include "session/previews/foci_pressures.hpp"
#include "session/replay.hpp"
#include "session/session.hpp"
#include "support/boards.hpp"
#include "support/thrown.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

using test::finger_at;

std::vector<geometry::Solid> cube(double press_depth_m) {
  auto solids = test::asset_solids("cube");
  solids[0].haptics.press_depth_m = press_depth_m;
  return solids;
}

struct Touching : test::OnBackends {};

std::string kinds(std::span<const Event> events) {
  std::string text;
  for (const Event& event : events)
    text += std::string(text.empty() ? "" : " ") + std::string(word_of(event_words, event.kind));
  return text;
}

TEST_P(Touching, TellsWhatAFingerDoes) {
  Session session = make({.solids = cube(0.003)});
  EXPECT_EQ(session.touch(finger_at({0, 0.002, 0}), 0.00).finger_count, 0U);
  EXPECT_EQ(kinds(session.events()), "");
  const touch::Touch& light = session.touch(finger_at({0, -0.0007, 0}), 0.01);
  ASSERT_EQ(light.finger_count, 1U);
  EXPECT_NEAR(light.fingers[0].depth_m, 0.0007, 1e-5);
  EXPECT_EQ(kinds(session.events()), "touch");
  EXPECT_EQ(session.solid_name(session.events()[0]), "cube");
  session.touch(finger_at({0, -0.0032, 0}), 0.02);
  EXPECT_EQ(kinds(session.events()), "move press");
  EXPECT_NEAR(session.events()[1].depth_m, 0.0032, 1e-5) << "the tip's, not that of the contacts";
  session.touch(finger_at({0.004, -0.0032, 0}), 0.03);
  EXPECT_EQ(kinds(session.events()), "move");
  EXPECT_NEAR(session.events()[0].centroid.x, 0.004, 3e-4);
  const auto schedule = session.schedule();
  ASSERT_EQ(schedule.voice_count, 1U);
  EXPECT_EQ(schedule.voices[0].foci.size(), 10U);
  EXPECT_EQ(schedule.time_s, 0.03);
  session.touch(std::vector<glm::vec3>(), 0.04);
  EXPECT_EQ(session.schedule().voice_count, 0U) << "silence at once";
  EXPECT_EQ(kinds(session.events()), "");
  session.touch(finger_at({0, 0.01, 0}), 0.085);
  EXPECT_EQ(kinds(session.events()), "release");
  session.touch(finger_at({0, -0.001, 0}), 0.09);
  EXPECT_EQ(kinds(session.end()), "release");
}

TEST_P(Touching, FollowsASolidThatMoves) {
  Session session = make({.solids = cube(0.003)});
  EXPECT_EQ(session.touch(std::vector<glm::vec3>(), 0.00).finger_count, 0U);
  EXPECT_EQ(session.touch(finger_at({0, 0.05, 0}), 0.01).finger_count, 0U);
  Transform T(1.0);
  T[3] = Vec4(0, 0.0535, 0, 1);  // up to 3.5 mm above the fingertip
  session.set_pose(0, T);
  EXPECT_EQ(session.touch(finger_at({0, 0.05, 0}), 0.02).finger_count, 1U);
  EXPECT_EQ(kinds(session.events()), "touch press");
  EXPECT_NEAR(session.events()[0].depth_m, 0.0035, 1e-5);
}

TEST_P(Touching, TakesDepthFrames) {
  const std::vector<sensing::Camera> cameras = test::paper_cameras();
  sensing::SyntheticRig synthetic(cameras, {}, sensing::Noise::none, 1);
  Transform T(1.0);
  T[3] = Vec4(0, -0.003, 0, 1);
  const sensing::Posed skin{&test::finger_skin().mesh, T};
  sensing::FrameSet set;
  synthetic.render(std::span(&skin, 1), 0, set);
  Session session = make({.solids = cube(0.001), .cameras = cameras});
  EXPECT_EQ(session.touch(set.frames, 0).finger_count, 1U);
  EXPECT_EQ(kinds(session.events()), "touch press");
  EXPECT_ERROR(session.touch(finger_at({}), 0.1), Exit::usage, "a session with cameras");
  EXPECT_ERROR(make({.solids = cube(0.001)}).touch(set.frames, 0), Exit::usage, "a session without cameras");
  set.frames[1].depth.pop_back();
  EXPECT_ERROR(session.touch(set.frames, 0.2), Exit::usage,
               "depth frame 1 has 407039 pixels, but its camera has 848x480");
  set.frames.pop_back();
  EXPECT_ERROR(session.touch(set.frames, 0.2), Exit::usage, "2 depth frames for 3 cameras");
}

TEST(Sessions, RefuseWhatCannotSound) {
  const double nan = std::nan("");
  const struct {
    std::function<void(SessionSetting&)> ask;
    std::string fault;
  } cases[]{
      {[](SessionSetting& setting) { setting.schedule.voice.stride = 5; }, "stride 5 and 10 foci"},
      {[](SessionSetting& setting) { setting.touch.foci = 0; }, "0 foci"},
      {[](SessionSetting& setting) { setting.hold_s = 0; }, "hold of 0 s"},
      {[](SessionSetting& setting) { setting.hold_s = -1; }, "hold of -1 s"},
      {[=](SessionSetting& setting) { setting.hold_s = nan; }, "hold of nan s"},  // it would never be silent
      {[](SessionSetting& setting) { setting.schedule.voice.dwell_s = 0; }, "dwell of 0 s"},
      {[=](SessionSetting& setting) { setting.schedule.voice.dwell_s = nan; }, "dwell of nan s"},
      {[=](SessionSetting& setting) { setting.safety.ceiling = nan; }, "ceiling"},
  };
  for (const auto& one : cases) {
    SessionSetting setting{.solids = cube(0.001)};
    one.ask(setting);
    EXPECT_ERROR(Session(std::move(setting)), Exit::usage, one.fault);
  }
}

TEST_P(Touching, AsksForAPressureAndTellsWhatItReaches) {
  SessionSetting setting{.solids = cube(0.003), .layout = test::posed_openmpd()};
  setting.schedule.voice.pressure_pa = 1500;
  setting.solids[0].haptics.intensity = 0.5;
  Session session = make(setting);
  session.touch(finger_at({0, -0.003, 0}), 0);
  ASSERT_EQ(session.schedule().voice_count, 1U);
  EXPECT_NEAR(session.schedule().voices[0].reached_pa.value_or(0), 750, 1);
  const auto pressures = foci_pressures(session.plan(), session.setting());
  EXPECT_FALSE(pressures.at(0).empty());
  for (const double pressure : pressures[0])
    EXPECT_NEAR(pressure, 750, 2);
  const bool timed = std::ranges::any_of(
      session.report().passes, [](const gpu::PassTime& pass) { return std::string_view(pass.name) == "pressures"; });
  EXPECT_EQ(timed, GetParam()) << "on the host, it is part of the drives";

  setting.solids[0].haptics.pressure_pa = 500;  // the solid's own value has precedence
  Session own = make(setting);
  own.touch(finger_at({0, -0.003, 0}), 0);
  EXPECT_NEAR(own.schedule().voices[0].reached_pa.value_or(0), 250, 1);

  setting.drive.solver = array::Solver::greedy;
  EXPECT_ERROR(make(setting), Exit::usage, "solver greedy");
  setting.drive.solver = array::Solver::naive;
  setting.schedule.voice.pressure_pa = 2e5;
  EXPECT_ERROR(make(setting), Exit::usage, "pressure of 200000 Pa");
}

TEST(SessionPressures, HoldWhereSlotsDoNotRepeatSoonEnoughToBeListed) {
  SessionSetting setting{.layout = array::load_layout("openmpd")};
  Plan plan;
  for (const double x : {-0.015, 0.015}) {
    array::Voice& voice = plan.schedule.add_voice();
    for (int j = 0; j < 7; ++j)
      voice.foci.emplace_back(x + 2e-3 * std::cos(0.9 * j), 2e-3 * std::sin(0.9 * j), 0.15);
    array::fill_order(7, 2, voice.order);
    voice.dwell_s = x < 0 ? 1.5e-3 : 1.637e-3;
    voice.pressure_pa = x < 0 ? 1000 : 500;
  }
  array::Loudness loudness(setting.layout, setting.drive);
  SlotWork work;
  plan_slots(plan, work, &loudness, [](const auto&, const auto&) { FAIL() << "nothing is listed"; });
  ASSERT_EQ(plan.cycle.plays, Plays::slot_by_slot);
  const auto pressures = foci_pressures(plan, setting);
  for (int j = 0; j < 7; ++j) {
    EXPECT_NEAR(pressures[0][j], 1000, 5);
    EXPECT_NEAR(pressures[1][j], 500, 5);
  }
}

/// Fingers in two cubes, whose dwells do not repeat together.
TEST_P(Touching, ASlowSolverIsNotLeftToTheOutput) {
  SessionSetting setting{.solids = cube(0.003), .layout = array::load_layout("openmpd")};
  setting.solids.push_back(setting.solids[0]);
  setting.solids[1].name = "other";
  setting.solids[1].haptics.dwell_s = 1.637e-3;
  setting.drive.constraint = array::Constraint::uniform;
  constexpr std::uint64_t first = 777;
  std::vector<glm::vec3> points = finger_at({0, -0.003, 0});
  const std::vector<glm::vec3> others = finger_at({0.1, -0.003, 0});
  points.insert(points.end(), others.begin(), others.end());
  Transform T(1.0);
  T[3] = Vec4(0.1, 0, 0, 1);
  const auto touch = [&](Session& session) {
    session.set_pose(1, T);
    EXPECT_EQ(session.touch(points, 0, first).finger_count, 2U);
  };
  setting.drive.solver = array::Solver::gs_pat;
  Session quick = make(setting);
  touch(quick);
  EXPECT_EQ(quick.plan().cycle.plays, Plays::slot_by_slot);
  setting.drive.solver = array::Solver::loudest;
  Session slow = make(setting);
  touch(slow);
  const Plan& plan = slow.plan();
  ASSERT_EQ(plan.cycle.length, least_unrepeated_slots);
  for (const std::uint64_t slot : {first, first + 7, first + least_unrepeated_slots - 1}) {
    std::vector<array::SlotFocus> foci;
    array::foci_of_slot(plan.schedule, slot, foci);
    ASSERT_EQ(foci.size(), 2U);
    const array::Drive expected = array::drive_for(setting.layout, foci, setting.drive);
    const auto drive = plan.drive(slot, expected.size());
    for (std::size_t t = 0; t < expected.size(); ++t)
      ASSERT_NEAR(std::remainder(drive[t].phase - expected[t].phase, 2 * M_PI), 0, 1e-5) << slot;
  }
  setting.frame_by_frame = true;  // nothing waits for its slots
  Session single = make(setting);
  touch(single);
  EXPECT_EQ(single.plan().cycle.plays, Plays::slot_by_slot);
}

TEST(Sessions, LetBoardsComputePhasesOnlyAtTheirOwnFrequency) {
  SessionSetting setting{.solids = cube(0.003), .layout = array::load_layout("autd3")};
  EXPECT_TRUE(Session(setting).link_setting().free_field);
  setting.drive.medium.frequency = 41e3;
  EXPECT_FALSE(Session(setting).link_setting().free_field);
}

TEST(Sessions, TellTheLinkWhetherFociMove) {
  SessionSetting setting{.solids = cube(0.003), .layout = array::load_layout(test::on_off_board())};
  EXPECT_TRUE(Session(setting).link_setting().foci_move);
  setting.schedule.own_method = [](const touch::Touch&, const touch::Finger&, touch::Placement&) {};
  EXPECT_TRUE(Session(setting).link_setting().foci_move) << "its foci may be any";
  for (const touch::Method still : {touch::Method::single_focus, touch::Method::multi_focus}) {
    setting.schedule.method.method = still;
    EXPECT_FALSE(Session(setting).link_setting().foci_move) << "also of an own method, by its caller's word";
  }
}

TEST_P(Touching, ASolverOfOnesOwnMakesEveryDrive) {
  SessionSetting setting{.solids = cube(0.003), .layout = array::load_layout("openmpd")};
  std::size_t calls = 0;
  setting.own_solver = [&calls](const array::Layout& layout, const array::DriveOptions&,
                                std::span<const array::SlotFocus> foci, std::span<array::TransducerDrive> out) {
    EXPECT_EQ(out.size(), layout.transducers.size());
    EXPECT_EQ(foci.size(), 1U);
    std::ranges::fill(out, array::TransducerDrive{0.25F * foci[0].gain, static_cast<float>(calls++ % 3)});
  };
  Session session = make(setting);
  EXPECT_FALSE(session.link_setting().free_field) << "no board can compute its phases";
  session.touch(finger_at({0, -0.003, 0}), 0);
  const Plan& plan = session.plan();
  ASSERT_EQ(plan.cycle.length, 10U);
  EXPECT_EQ(calls, 10U);
  for (std::uint64_t slot = 0; slot < 10; ++slot) {
    const auto drive = plan.drive(slot, setting.layout.transducers.size());
    EXPECT_EQ(drive.front().amplitude, 0.25F);
    EXPECT_EQ(drive.back().phase, static_cast<float>(slot % 3));
  }
  session.touch(finger_at({0, 0.01, 0}), 0.1);
  EXPECT_EQ(calls, 10U) << "nothing is touched";
  setting.schedule.voice.pressure_pa = 300;
  EXPECT_ERROR(make(setting), Exit::usage, "a solver of one's own");
}

/// A cube under the paper's cameras and array, and a finger that dips into it.
struct Live {
  SessionSetting setting{.solids = cube(0.003),
                         .cameras = test::paper_cameras(),
                         .layout = array::load_layout("autd3"),
                         .keep_boards = true};  // the board is not rendered, and the finger is where it would stand
  test::SpyLink link;
  std::atomic<bool> stop{false};
  std::vector<Event> told;
  std::uint64_t planned = 0;
  test::Watcher watcher;
  RunOptions options{.every_frame = true, .observer = &watcher};

  Live() {
    watcher.on_events = [this](auto events) { told.insert(told.end(), events.begin(), events.end()); };
    watcher.on_planned = [this](const FrameReport& report, const Plan&) { planned = report.sequence + 1; };
  }
  LoopStats run() {
    Session session(setting);
    return run(session);
  }
  LoopStats run(Session& session) {
    const auto source =
        sensing::make_synthetic_source(setting.cameras, test::finger_skin().mesh, {}, {.paced = false, .frames = 12});
    return session.run(*source, link, stop, options);
  }
};

TEST(SessionRuns, ToTheEndOfItsSourceAndLetsGo) {
  Live live;
  live.setting.hold_s = 0.4;  // plans of a busy machine are late
  const LoopStats stats = live.run();
  EXPECT_EQ(stats.captured, 12U);
  EXPECT_EQ(stats.planned, 12U);
  EXPECT_EQ(live.planned, 12U);
  EXPECT_EQ(kinds(live.told).substr(0, 5), "touch");
  EXPECT_EQ(live.told.back().kind, EventKind::release) << "the source ended in the middle of a touch";
  EXPECT_GT(*std::max_element(live.link.loudest.begin(), live.link.loudest.end()), 0.0F);
  EXPECT_TRUE(live.link.ended_silent());
}

TEST(SessionRuns, PointsOnItsBoardsAndOutsideTheRoomAreNoSkin) {
  Live live;
  EXPECT_FALSE(live.run().dropped.has_value()) << "nothing can be dropped";
  live.setting.keep_boards = false;
  LoopStats stats = live.run();
  ASSERT_TRUE(stats.dropped.has_value());
  EXPECT_GT((*stats.dropped)[sensing::NoSkin::board], 1000U);
  EXPECT_EQ((*stats.dropped)[sensing::NoSkin::board], stats.dropped->total());
  EXPECT_EQ(stats.touching, 0U) << "the whole fingertip is over the board";
  live.setting.keep_boards = true;
  live.setting.surroundings.room = Box{Vec3(-1), Vec3(1, 1, 0)};
  stats = live.run();
  ASSERT_TRUE(stats.dropped.has_value());
  EXPECT_GT((*stats.dropped)[sensing::NoSkin::room], 100U) << "half of the finger";
  EXPECT_GT(stats.touching, 0U);
}

TEST(SessionReplays, AndSaysWhatTheFirstFrameWaitsFor) {
  Live live;
  Session session(test::test_device(), live.setting);
  const auto source = sensing::make_synthetic_source(live.setting.cameras, {}, {}, {.paced = false, .frames = 1});
  // A thread that is cancelled says what it was about to do.
  const std::atomic<bool> cancelled{true};
  const Cancellable thread(cancelled);
  EXPECT_ERROR(replay(session, *source, live.link, live.stop), Exit::failed, "cancelled before: compiling shaders");
}

TEST(SessionRuns, AgainAfterItWasStoppedWithFramesUnderWay) {
  Live live;
  Session session(test::test_device(), live.setting);
  const auto counts = live.watcher.on_planned;
  live.watcher.on_planned = [&](const FrameReport& report, const Plan&) { live.stop = report.sequence == 3; };
  EXPECT_LT(live.run(session).planned, 12U);
  live.stop = false;
  live.watcher.on_planned = counts;
  std::uint64_t written = 0;
  live.options.record = [&](const sensing::FrameSet&) { ++written; };
  EXPECT_EQ(live.run(session).planned, 12U);
  EXPECT_EQ(written, 12U);
  EXPECT_FALSE(live.stop) << "a recording that went well stops nothing";
  EXPECT_TRUE(live.link.ended_silent());

  sensing::FrameSet dark;
  for (const sensing::Camera& camera : live.setting.cameras)
    dark.frames.push_back({std::vector<std::uint16_t>(std::size_t{camera.width} * camera.height), 0});
  EXPECT_EQ(session.touch(dark.frames, 1e3).finger_count, 0U) << "this frame, not one that was still under way";
}

/// Gives a run another scene once something touches, and moves the new scene's solid away after its fifth frame.
struct AnotherScene final : RunChanges {
  std::unique_ptr<Session> next;
  std::atomic<bool> ready{false};
  int frames = 0;  ///< of the new scene

  bool has_scene() const override { return ready; }
  void take_scene(Session& session) override {
    session.exchange_scene(*next);
    ready = false;
  }
  void before_frame(Session& session) override {
    if (session.solids()[0].name == "other" && ++frames == 5)
      session.set_pose(0, glm::translate(Transform(1.0), Vec3(0, -0.5, 0)));
  }
};

TEST_P(Touching, AnotherSceneComesBetweenTwoFrames) {
  Live live;
  AnotherScene changes;
  live.options.changes = &changes;
  SessionSetting setting = live.setting;
  setting.solids[0].name = "other";
  changes.next = std::make_unique<Session>(make(setting));
  std::vector<std::string> frames;  // fingers, voices, and the name of the solid that the link gets
  bool changed = false;
  live.watcher.on_planned = [&](const FrameReport& report, const Plan& plan) {
    const auto& names = plan.schedule.solid_names;
    frames.push_back(fmt::format("{} {} {}", report.touch->finger_count, plan.schedule.voice_count,
                                 names ? names->front() : "cube"));
    if (report.touch->finger_count > 0 && !std::exchange(changed, true)) changes.ready = true;
  };
  Session session = make(live.setting);
  const LoopStats stats = live.run(session);
  EXPECT_EQ(stats.planned, 12U);
  EXPECT_EQ(stats.solids, (std::vector<std::string>{"cube", "other"}));
  ASSERT_TRUE(changed);
  const auto first = std::ranges::find_if(frames, [](const std::string& frame) { return frame.ends_with("other"); });
  ASSERT_GE(frames.end() - first, 6);
  EXPECT_EQ(first[-1], "1 1 cube");
  EXPECT_EQ(first[0], "1 0 other") << "a frame of silence";
  EXPECT_EQ(first[1], "1 1 other");
  EXPECT_EQ(first[3], "1 1 other");
  EXPECT_EQ(first[4], "0 0 other") << "the pose holds from the frame before which it was set";
  // The touch of the previous scene ends before the next one's begins.
  const auto release = std::ranges::find(live.told, EventKind::release, &Event::kind);
  const auto last_touch = std::find_if(live.told.rbegin(), live.told.rend(),
                                       [](const Event& event) { return event.kind == EventKind::touch; });
  EXPECT_LT(release - live.told.begin(), last_touch.base() - live.told.begin());
  EXPECT_EQ(std::ranges::count(live.told, EventKind::touch, &Event::kind), 2);
  EXPECT_NE(live.told.back().finger, release->finger) << "numbers go on counting";
  EXPECT_EQ(live.told.back().kind, EventKind::release);
  EXPECT_TRUE(live.link.ended_silent());
}

/// A link that plays plans by its own clock.
struct PlanLink final : test::SpyLink {
  bool plays_plans() const override { return true; }
};

TEST(SessionRuns, PlansOfAnotherSceneListStandingDrivesToo) {
  Live live;
  live.setting.predict = {Predict::automatic, 0.02};
  live.options.every_frame = false;
  AnotherScene changes;
  live.options.changes = &changes;
  changes.frames = 5;  // its solid stays
  SessionSetting setting = live.setting;
  setting.solids[0].name = "other";
  changes.next = std::make_unique<Session>(setting);
  int here = 0, other = 0;  // plans whose foci move
  live.watcher.on_planned = [&](const FrameReport&, const Plan& plan) {
    if (!plan.schedule.advance.moves()) return;
    EXPECT_EQ(plan.standing, plan.cycle.length) << here << ", " << other;
    const bool changed = plan.schedule.solid_names != nullptr;
    if (!changed && ++here == 1) changes.ready = true;
    if (changed && ++other == 2) live.stop = true;
  };
  const auto source = sensing::make_synthetic_source(
      live.setting.cameras, test::finger_skin().mesh, {},
      {.motion = [](double t) { return glm::translate(Transform(1.0), Vec3(6e-3 * std::sin(15 * t), -3e-3, 0)); },
       .frames = 200000});  // it is stopped before
  PlanLink link;
  Session(live.setting).run(*source, link, live.stop, live.options);
  EXPECT_GT(here, 0);
  EXPECT_GE(other, 2);
}

TEST(SessionRuns, ToAnErrorInSilenceAndLetsGo) {
  Live live;
  live.watcher.on_planned = [](const FrameReport& report, const Plan&) {
    if (report.sequence == 8) throw failure("the disk is full");
  };
  EXPECT_ERROR(live.run(), Exit::failed, "the disk is full");
  ASSERT_FALSE(live.told.empty());
  EXPECT_EQ(live.told.back().kind, EventKind::release);
  EXPECT_TRUE(live.link.ended_silent());
}

TEST(SessionRuns, AndReportsWhatItPredicts) {
  Live live;
  live.setting.predict = {.predict = Predict::automatic, .latency_s = 0.02};
  const LoopStats stats = live.run();
  ASSERT_TRUE(stats.prediction);
  EXPECT_NEAR(stats.prediction->latency_s.quantile(0.5), 0.02, 1e-3);
}

TEST(SessionRuns, OnlyWithAllThatItNeeds) {
  Live blind, deaf;
  blind.setting.layout = {};
  EXPECT_ERROR(blind.run(), Exit::usage, "without an array");
  deaf.setting.events.reset();
  test::DeafSink sink;
  deaf.options.events = &sink;
  EXPECT_ERROR(deaf.run(), Exit::usage, "a session whose setting has no events");
  deaf.options.events = nullptr;
  EXPECT_EQ(deaf.run().planned, 12U);
  Live tuned;
  tuned.setting.schedule.tune = Tune::all;
  EXPECT_ERROR(tuned.run(), Exit::usage, "tune strides only");
}

INSTANTIATE_TEST_SUITE_P(Backends, Touching, testing::Bool(), test::backend_name);

}  // namespace
}  // namespace palpa::session
