// Exactly at the limits of a run: what the value itself does, and what the next one does.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "array/schedule.hpp"
#include "fakes.hpp"
#include "session/loop/frame_queue.hpp"
#include "session/loop/output.hpp"
#include "session/plan/feel.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "session/predict/capture_times.hpp"
#include "session/predict/motion_filter.hpp"
#include "session/predict/prediction.hpp"
#include "session/predict/predictor.hpp"
#include "session/replay.hpp"
#include "session/sensation_control.hpp"
#include "session/watch/effort.hpp"
#include "session/watch/pressure_log.hpp"
#include "session/watch/sound_watch.hpp"
#include "session/watch/touches.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

constexpr double more = std::numeric_limits<double>::infinity();

double after(double value) {
  return std::nextafter(value, more);
}

float after(float value) {
  return std::nextafter(value, std::numeric_limits<float>::infinity());
}

/// The frame, counted from 1, that changes the effort; 0: none of 300.
int changes_at(EffortControl& control, const FrameTimes& frame) {
  for (int n = 1; n <= 300; ++n) {
    if (control.planned(frame)) return n;
  }
  return 0;
}

TEST(AtLimits, WorkIsShedAboveFourFifthsOfTheHoldInThreeFrames) {
  constexpr double hold_s = 0.1, limit_s = EffortControl::most_of_hold * hold_s;
  EffortControl control(hold_s, {4, 3});
  EXPECT_EQ(changes_at(control, {.capture_to_plan_s = limit_s}), 0);
  EXPECT_EQ(changes_at(control, {.capture_to_plan_s = after(limit_s)}), 3);
  EXPECT_EQ(changes_at(control, {.capture_to_plan_s = after(limit_s)}), 4 + 3) << "four frames began before the change";
}

TEST(AtLimits, AStepIsTakenBackUpToTheTimesThatFit) {
  constexpr double hold_s = 0.1, sure_s = EffortControl::sure_below * hold_s,
                   calm_s = EffortControl::calm_below * hold_s;
  const auto taken_back_at = [&](const FrameTimes& frame) {
    EffortControl control(hold_s, {4, 3});
    changes_at(control, {.capture_to_plan_s = hold_s});
    return changes_at(control, frame);
  };
  EXPECT_EQ(taken_back_at({.capture_to_plan_s = sure_s}), 4 + 90);
  EXPECT_EQ(taken_back_at({.capture_to_plan_s = after(sure_s)}), 0);
  EXPECT_EQ(taken_back_at({.work_s = calm_s, .apart_s = 1}), 4 + 90);
  EXPECT_EQ(taken_back_at({.work_s = after(calm_s), .apart_s = 1}), 0);
}

TEST(AtLimits, WhatWasShedIsToldAfter32SteadyFrames) {
  EffortControl control(0.1, {4, 3});
  ShedReport report(0.1);
  const auto frames = [&](int count, double takes_s) {
    return test::stderr_of([&] {
      for (int n = 0; n < count; ++n) {
        control.planned({.capture_to_plan_s = takes_s});
        report.planned(control);
      }
    });
  };
  EXPECT_EQ(frames(3, 0.1), "");
  EXPECT_EQ(frames(31, 0.07), "");
  EXPECT_CONTAINS(frames(1, 0.07), "overloaded");
  EXPECT_EQ(frames(100, 0.07), "") << "once";
}

TEST(AtLimits, ALullOfExactlyItsLimitIsSound) {
  using namespace std::chrono_literals;
  const SoundWatch::Clock::time_point begin{1h};
  SoundWatch watch;
  watch.sent(true, std::nullopt, begin);
  EXPECT_TRUE(watch.sounding(begin + SoundWatch::longest_lull));
  EXPECT_FALSE(watch.sounding(begin + SoundWatch::longest_lull + 1ns));
}

/// A finger at (x, 0, 0).
touch::Touch finger(float depth_m, float x_m = 0, std::uint32_t id = 1) {
  touch::Touch touch;
  touch::Finger& finger = touch.fingers.emplace_back();
  finger.id = id;
  finger.depth_m = depth_m;
  finger.section.centroid = {x_m, 0, 0};
  touch.finger_count = 1;
  return touch;
}

struct TouchesAtLimits : testing::Test {
  static constexpr float press_m = 5.0F / 1024, rearm_m = 4.0F / 1024;  // four fifths: press_rearm
  static constexpr double hold_s = 0.125;                               // exact in binary, and so is its half
  std::vector<geometry::Solid> solids = std::vector<geometry::Solid>(1);
  TouchesAtLimits() { solids[0].haptics.press_depth_m = press_m; }
};

TEST_F(TouchesAtLimits, APressBeginsAtItsDepthAndEndsBelowFourFifths) {
  Touches touches(solids, hold_s);
  double time_s = 1;
  const auto pressed_at = [&](float depth_m) {
    touches.update(finger(depth_m), time_s += 0.01);
    return touches.held()[0].pressed;
  };
  EXPECT_FALSE(pressed_at(std::nextafter(press_m, 0.0F)));
  EXPECT_TRUE(pressed_at(press_m));
  EXPECT_TRUE(pressed_at(rearm_m));
  EXPECT_FALSE(pressed_at(std::nextafter(rearm_m, 0.0F)));
  EXPECT_FALSE(pressed_at(rearm_m));
}

TEST_F(TouchesAtLimits, AMissingFingerEndsAfterHalfTheHoldAndAnyAfterMoreThanTheHold) {
  for (const auto& [away_s, ends] : {std::pair(std::nextafter(1 + hold_s / 2, 0), 0U), {1 + hold_s / 2, 1U}}) {
    Touches touches(solids, hold_s);
    touches.update(finger(0.001F), 1);
    touches.update({}, away_s);
    EXPECT_EQ(touches.ended().size(), ends) << away_s;
  }
  for (const auto& [next_s, begins] : {std::pair(1 + hold_s, false), {after(1 + hold_s), true}}) {
    Touches touches(solids, hold_s);
    touches.update(finger(0.001F), 1);
    touches.update(finger(0.001F), next_s);
    EXPECT_EQ(touches.held()[0].begins, begins) << next_s;
  }
}

TEST_F(TouchesAtLimits, ALostPressComesBackWithinItsTimeAndPlace) {
  const auto presses_again = [&](double back_s, float x_m) {
    Touches touches(solids, hold_s);
    touches.update(finger(press_m), 0);
    touches.update({}, 0.1, 0);
    touches.update(finger(press_m, x_m, 7), back_s);
    return touches.held()[0].presses;
  };
  constexpr auto place_m = static_cast<float>(lost_press_m);
  EXPECT_FALSE(presses_again(lost_press_s, 0));
  EXPECT_TRUE(presses_again(after(lost_press_s), 0));
  EXPECT_FALSE(presses_again(0.15, place_m));
  EXPECT_TRUE(presses_again(0.15, after(place_m)));
}

TEST_F(TouchesAtLimits, NoMoreTouchesThanTheyHaveRoomForAreHeld) {
  Touches touches(solids, 1);
  std::uint32_t id = 0;
  const auto frame = [&](std::size_t count) {
    touch::Touch touch;
    for (std::size_t n = 0; n < count; ++n)
      touch.fingers.push_back(finger(0.001F, 0, ++id).fingers[0]);
    touch.finger_count = static_cast<std::uint32_t>(count);
    touches.update(touch, 1 + 1e-3 * id);
    return touches.ended().size();
  };
  for (int n = 0; n < 5; ++n)
    EXPECT_EQ(frame(touch::max_fingers), 0U);
  EXPECT_EQ(frame(0), touch::max_fingers) << "256 that are missing may come back";
  EXPECT_EQ(frame(1), 0U);
  EXPECT_EQ(frame(0), 1U);
}

TEST(AtLimits, CaptureTimesAreToldBeyondTheirLimits) {
  const auto says = [](const std::function<void(CaptureTimes&)>& frames) {
    return !test::stderr_of([&] {
              CaptureTimes times;
              frames(times);
            }).empty();
  };
  for (const bool beyond : {false, true}) {
    const auto of = [&](double limit) { return beyond ? after(limit) : limit; };
    EXPECT_EQ(says([&](CaptureTimes& times) {
                times.see(0, 5, 0);
                times.see(of(1 + CaptureTimes::longest_jump_s), 6, 0);
              }),
              beyond);
    EXPECT_EQ(says([&](CaptureTimes& times) {
                times.see(0);
                times.see(of(CaptureTimes::longest_gap_s));
              }),
              beyond);
    EXPECT_EQ(says([&](CaptureTimes& times) {
                for (int n = beyond ? 0 : 1; n < 3; ++n)
                  times.see(1);
              }),
              beyond);
    EXPECT_EQ(says([&](CaptureTimes& times) {
                for (int n = 0; n < 20; ++n)
                  times.see(n, n, of(most_ahead_s));
              }),
              beyond);
    EXPECT_EQ(says([&](CaptureTimes& times) {
                for (int n = 0; n < 50; ++n)  // the first has nothing before it
                  times.see(n, n, n >= 1 && n <= (beyond ? 6 : 5) ? 1 : 0);
              }),
              beyond);
  }
}

TEST(AtLimits, AMotionGoesOnAfterAPauseOfExactlyItsLimit) {
  for (const auto& [pause_s, moves] :
       {std::pair(MotionFilter::longest_pause_s, true), {after(MotionFilter::longest_pause_s), false}}) {
    MotionFilter filter;
    filter.see(0, Vec3(0));
    filter.see(pause_s, Vec3(0.02, 0, 0));
    EXPECT_EQ(filter.velocity().x > 0, moves) << pause_s;
  }
}

TEST(AtLimits, APredictionIsClampedBeyondItsLimit) {
  EXPECT_FALSE(ahead_of(std::nullopt, most_ahead_s, 1, 1e-3).clamped);
  EXPECT_TRUE(ahead_of(std::nullopt, after(most_ahead_s), 1, 1e-3).clamped);
}

TEST(AtLimits, GainsFollowAVibrationOfExactlyTheFastestFrequency) {
  EXPECT_TRUE(carries({.slot_s = 2e-3}, 200));
  EXPECT_FALSE(carries({.slot_s = 2e-3}, 200.001));
  EXPECT_TRUE(carries({.slot_s = 10, .steady = true}, 0));
}

TEST(AtLimits, AFingerClicksAgainAfterExactlyItsTime) {
  for (const auto& [second_s, clicks] :
       {std::pair(std::nextafter(between_clicks_s, 0), false), {between_clicks_s, true}}) {
    geometry::Solid solid;
    solid.haptics.press_depth_m = 0.003;
    solid.haptics.click.emplace();
    const std::vector<geometry::Solid> solids{solid};
    Scheduler scheduler("scene.glb", solids, {}, {});
    array::Schedule schedule;
    array::reserve(schedule, touch::max_fingers, touch::max_foci);
    const auto is_clicking = [&](double time_s, float depth_m) {
      touch::Touch touch = finger(depth_m);
      for (int n = 0; n < 10; ++n)
        touch.fingers[0].foci.push_back({glm::vec3(0.001F * static_cast<float>(n), 0, 0), 7});
      scheduler.make(touch, time_s, schedule,
                     {.follows = true, .first_slot = static_cast<std::uint64_t>(time_s * 1000)});
      return schedule.voices[0].foci.size() == 1;
    };
    is_clicking(-0.01, 0.001F);
    EXPECT_TRUE(is_clicking(0, 0.004F));
    is_clicking(0.05, 0.001F);
    EXPECT_EQ(is_clicking(second_s, 0.004F), clicks) << second_s;
  }
}

TEST(AtLimits, SilenceComesFirstAboveHalfOfTheGain) {
  for (const auto& [gain, first] : {std::pair(most_resting_gain, false), {after(most_resting_gain), true}}) {
    geometry::Solid solid;
    solid.haptics.intensity = gain;
    solid.haptics.press_depth_m = 0.003;
    solid.haptics.click.emplace();
    const std::vector<geometry::Solid> solids{solid};
    Scheduler scheduler("scene.glb", solids, {}, {});
    array::Schedule schedule;
    array::reserve(schedule, touch::max_fingers, touch::max_foci);
    for (const float depth_m : {0.001F, 0.004F}) {
      touch::Touch touch = finger(depth_m);
      touch.fingers[0].foci.push_back({glm::vec3(0, 0, 0), 7});
      scheduler.make(touch, depth_m, schedule, {.follows = true, .first_slot = 100});
    }
    EXPECT_EQ(schedule.voices[0].course.begin_slot > 100, first) << gain;
  }
}

/// Silent slots that a player sends in a pause of 20,000 slots.
std::uint64_t silent_slots_of(double slot_s) {
  test::SpyLink link;
  const OutputSetting setting{.layout = test::small_layout(), .slot_s = slot_s, .hold_s = slot_s};
  Player player(link, setting);
  const std::atomic<bool> stop = false;
  const Plan nothing;
  player.play_until(20'000, nothing, stop);
  return player.silent_drives();
}

TEST(AtLimits, ASilenceIsPlayedUpToItsLimits) {
  EXPECT_EQ(silent_slots_of(0.0625), static_cast<std::uint64_t>(most_silence_s / 0.0625));
  EXPECT_EQ(silent_slots_of(0.0009765625), most_silent_slots);
}

TEST(AtLimits, APlanSoundsUntilItsHoldIsOver) {
  const OutputSetting setting{.layout = test::small_layout(), .slot_s = 0.001, .hold_s = 0.125};
  Plan plan;
  plan.schedule = test::touching(Vec3(0, 0.15, 0));
  plan.captured_s = 1;
  test::list_drives(setting.layout, plan);
  SlotScratch scratch;
  scratch.reserve(setting);
  const auto sounds = [&](double now_s) {
    return test::loudest_of(drive_of_slot(plan, 0, now_s, setting, scratch)) > 0;
  };
  EXPECT_TRUE(sounds(std::nextafter(1.125, 0)));
  EXPECT_FALSE(sounds(1.125));
  plan.more_hold_s = 0.125;
  EXPECT_TRUE(sounds(std::nextafter(1.25, 0)));
  EXPECT_FALSE(sounds(1.25));
}

TEST(AtLimits, FociAdvanceIfTheirDrivesCanBeListed) {
  for (const std::uint32_t foci : {most_cycle / 3, most_cycle / 3 + 1}) {
    Plan plan;
    array::Voice& voice = plan.schedule.add_voice();
    for (std::uint32_t n = 0; n < foci; ++n) {
      voice.foci.emplace_back(1e-3 * n, 0.15, 0);
      voice.order.push_back(n);
    }
    voice.foci_per_slot = 1;
    voice.dwell_s = plan.schedule.slot_s;
    voice.velocity = Vec3(0.1, 0, 0);
    plan.schedule.advance = {.cycle = foci, .cycles = 2, .most_s = 1};
    SlotWork work;
    work.lists_standing = true;
    begin_slots(plan, work);
    EXPECT_EQ(plan.schedule.advance.moves(), 3 * foci <= most_cycle) << foci;
    EXPECT_EQ(plan.standing, 3 * foci <= most_cycle ? foci : 0) << foci;
  }
}

TEST(AtLimits, AQueueOfFramesIsFullBeyondItsBytes) {
  sensing::FrameSet set;
  set.frames.resize(1);
  set.frames[0].depth.resize(50);
  FrameQueue queue(2 * 101);
  EXPECT_FALSE(queue.add(set));
  EXPECT_FALSE(queue.add(set)) << "exactly full";
  EXPECT_TRUE(queue.add(set));
  EXPECT_EQ(queue.waiting(), 2U);
}

TEST(AtLimits, ASensationStartsWithinItsTimesAndKeepsItsNewestPoints) {
  SensationControl control;
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(test::error_of([&] { control.play(sign * most_start_s, 0); }), "");
    EXPECT_CONTAINS(test::error_of([&] { control.play(sign * after(most_start_s), 0); }, Exit::usage), "at most");
    EXPECT_CONTAINS(test::error_of([&] { control.play(0, sign * after(most_start_s)); }, Exit::usage), "at most");
  }
  for (int n = 0; n < 1024; ++n)
    control.sounded({});
  EXPECT_EQ(control.newest(5000).size(), 1024U);
  control.sounded({});
  EXPECT_EQ(control.newest(5000).size(), 1024U);
  EXPECT_EQ(control.newest(3).size(), 3U);
}

TEST(AtLimits, PressuresAreKeptOfTheFirstFingersAndReachedAt99Percent) {
  const std::vector<std::string> names{"cube"};
  PressureLog log(names);
  array::Schedule schedule;
  for (std::uint32_t id = 0; id <= PressureLog::most; ++id) {
    schedule.clear();
    array::Voice& voice = schedule.add_voice();
    voice.id = id;
    voice.solid = 0;
    voice.reached_pa = 100;
    log.planned(schedule);
    EXPECT_EQ(log.fingers().size(), std::min<std::size_t>(id + 1, PressureLog::most));
  }
  EXPECT_TRUE(is_reached(1000, 990));
  EXPECT_FALSE(is_reached(1000, std::nextafter(990.0, 0)));
  EXPECT_TRUE(is_reached(std::nextafter(1e-3, 0), 0));
  EXPECT_FALSE(is_reached(1e-3, 0));
  schedule.voices[0].reached_pa = array::linear_pressure_pa;
  EXPECT_FALSE(beyond_linear(schedule));
  schedule.voices[0].reached_pa = after(array::linear_pressure_pa);
  EXPECT_TRUE(beyond_linear(schedule));
}

}  // namespace
}  // namespace palpa::session
