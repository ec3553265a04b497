// Fingers that move, through the whole chain: where foci sound, compared with where the skin then is.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "geometry/gltf/gltf.hpp"
#include "predict_chain.hpp"
#include "sensing/recording.hpp"
#include "session/plan/plan.hpp"
#include "session/predict/capture_times.hpp"
#include "session/predict/predictor.hpp"
#include "session/predict/slot_clock.hpp"
#include "stepped_loop.hpp"
#include "support/captured.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

using test::chain_errors;
using test::ChainErrors;
using test::ChainFilm;

std::string text_of(const ChainErrors& errors) {
  const auto one = [](const test::ChainError& e) {
    return fmt::format("mean {:.2f} mm, p95 {:.2f} mm, steps {:.2f} mm, late {:.1f} ms", e.mean_m * 1e3, e.p95_m * 1e3,
                       e.p95_step_m * 1e3, e.late_s * 1e3);
  };
  return "seen: " + one(errors.seen) + "; predicted: " + one(errors.predicted);
}

TEST(PredictChain, KeepsFociOnSkinThatSlides) {
  const double any = 1;
  struct Case {
    const char* name;
    ChainFilm film;
    bool on_device;
    double seen_m, predicted_m, p95_m;
  };
  for (const Case& c : {Case{"along x", test::sliding_film(0.2, false, 0.3), false, 4e-3, 1e-3, 2e-3},
                        {"along z", test::sliding_film(0.2, true, 0.3), false, 4e-3, 1e-3, 2e-3},
                        {"on the device", test::sliding_film(0.2, false, 0.3), true, 4e-3, 1e-3, 2e-3},
                        // The truth is where the same session puts the foci without the sensor's noise.
                        {"a hand along x", test::hand_film(0.2, false, 0.3), false, 2.3e-3, 1.2e-3, any},
                        {"a hand along z", test::hand_film(0.2, true, 0.3), false, 2.3e-3, 1.2e-3, any}}) {
    const ChainErrors errors = chain_errors(c.film, 0.02, c.on_device);
    SCOPED_TRACE(c.name + (": " + text_of(errors)));
    ASSERT_GT(errors.predicted.slots, 100U);
    EXPECT_GT(errors.seen.mean_m, c.seen_m);
    EXPECT_LE(errors.predicted.mean_m, c.predicted_m);
    EXPECT_LE(errors.predicted.p95_m, c.p95_m);
    EXPECT_EQ(errors.predicted.begun, 0U);
  }
}

TEST(PredictChain, FollowsTheSurface) {
  const ChainErrors errors = chain_errors(test::crossing_film(0.2), 0.02, false);
  SCOPED_TRACE(text_of(errors));
  ASSERT_GT(errors.predicted.slots, 20U);
  EXPECT_LT(errors.predicted.mean_m, 0.4 * errors.seen.mean_m);
}

TEST(PredictChain, EndsWithAFingerThatLiftsAndBeginsNothing) {
  for (const double speed : {0.1, 0.3}) {
    const ChainErrors errors = chain_errors(test::lifting_film(speed), 0.02, false);
    SCOPED_TRACE(text_of(errors));
    EXPECT_LE(errors.predicted.late_s, errors.seen.late_s - 0.01) << "a frame and more sooner";
    EXPECT_EQ(errors.predicted.begun, 0U);
    EXPECT_EQ(chain_errors(test::lifting_film(-speed), 0.02, false).predicted.begun, 0U) << "it presses";
  }
}

TEST(PredictChain, ChangesNothingAtRest) {
  for (const double late_s : {0.01, 0.05}) {
    const ChainErrors errors = chain_errors(test::lifting_film(0), late_s, false);
    SCOPED_TRACE(text_of(errors));
    EXPECT_LE(errors.predicted.p95_step_m, 1.02 * errors.seen.p95_step_m);
    EXPECT_LE(errors.predicted.mean_m, 1.1 * errors.seen.mean_m);
  }
}

TEST(PredictBadTimes, PredictNothingAndBeginNothing) {
  const ChainFilm film = test::sliding_film(0.2, false, 0.15);
  const auto fastest = [&](const std::function<double(std::uint64_t)>& time_of) {
    double most = 0;
    for (const array::Schedule& schedule : test::schedules_of(film, 0.02, time_of)) {
      EXPECT_LE(schedule.voice_count, 1U);
      for (const array::Voice& voice : std::span(schedule.voices).first(schedule.voice_count))
        most = std::max(most, glm::length(voice.velocity));
    }
    return most;
  };
  EXPECT_GT(fastest([](auto k) { return 0.011 * static_cast<double>(k); }), 0.1);
  EXPECT_EQ(fastest([](auto k) { return 50 - 0.011 * static_cast<double>(k); }), 0) << "backwards";
  EXPECT_EQ(fastest([](auto) { return 3.0; }), 0) << "still";
  EXPECT_EQ(fastest([](auto k) { return 3600.0 * static_cast<double>(k); }), 0) << "by an hour";
  EXPECT_LT(fastest([](auto k) { return 1e-6 * static_cast<double>(k); }), 3.01) << "a thousand times too fast";
}

TEST(PredictFixed, GivesTheSameBytesAndWithoutSlotsTheMiddleOfTheCycle) {
  const ChainFilm film = test::sliding_film(0.2, false, 0.15);
  const auto time_of = [](std::uint64_t k) { return static_cast<double>(k) / 90; };
  const auto once = test::schedules_of(film, 0.02, time_of), again = test::schedules_of(film, 0.02, time_of);
  const auto standing = test::schedules_of(film, 0.02, time_of, false);
  ASSERT_EQ(once.size(), again.size());
  std::size_t moving = 0;
  for (std::size_t k = 0; k < once.size(); ++k) {
    ASSERT_EQ(once[k].voice_count, 1U);
    EXPECT_TRUE(std::ranges::equal(once[k].voices[0].foci, again[k].voices[0].foci));
    EXPECT_EQ(once[k].voices[0].velocity, again[k].voices[0].velocity);
    moving += once[k].advance.moves() ? 1 : 0;
    EXPECT_FALSE(standing[k].advance.moves());
    EXPECT_TRUE(std::ranges::equal(once[k].voices[0].foci, standing[k].voices[0].foci));
  }
  EXPECT_GT(moving, 5U);
}

TEST(PredictRecording, NeverSilencesAFingerThatStays) {
  PALPA_SHARED_OR_SKIP(folder, "hands-more/prediction-silences-a-frame");
  const sensing::Recording recording = sensing::load_recording(folder);
  SessionSetting setting{
      .solids = geometry::make_solids(geometry::load_gltf(test::shared_data("hands-more/plate-60.glb"))),
      .cameras = recording.cameras};
  setting.predict = {Predict::automatic, 20e-3};
  setting.layout.transducers.push_back({Vec3(0, -0.15, 0), Vec3(0, 1, 0)});
  Session session(std::move(setting));
  sensing::FrameSet set;
  for (std::size_t k = 0; k < recording.entries.size(); ++k) {
    sensing::read_entry(recording, k, set);
    const auto slot = static_cast<std::uint64_t>(std::ceil(recording.entries[k].time_s / 1.5e-3));
    EXPECT_EQ(session.touch(set.frames, recording.entries[k].time_s, slot).finger_count, 2U) << k;
    EXPECT_EQ(session.schedule().voice_count, 2U) << k;
  }
}

/// On either side: fingers are in the order of their contacts, so either is the first.
struct PredictFingers : testing::TestWithParam<double> {};

TEST_P(PredictFingers, MoveEachByItself) {
  const double x = GetParam();
  ChainFilm film = test::lifting_film(0.2);  // at rest for 0.12 s, gone 25 ms later
  const auto lifts = film.motion;
  film.motion = [&](double t) { return glm::translate(Transform(1), Vec3(x, 0, 0)) * lifts(t); };
  film.second = [&](double t) { return test::tip_at({-x, -0.003, t < 0.05 ? 0 : 0.1 * (t - 0.05)}); };
  std::vector<std::uint32_t> frames_with(3);
  double fastest = 0, slowest = 1;
  constexpr double late_s = 0.03;
  std::vector<double> distances_m;
  const std::vector<array::Schedule> schedules = test::schedules_of(
      film, late_s, [](std::uint64_t k) { return static_cast<double>(k) / 90; }, true, &distances_m);
  for (std::size_t k = 0; k < schedules.size(); ++k) {
    const array::Schedule& schedule = schedules[k];
    ASSERT_LE(schedule.voice_count, 2U);
    ++frames_with[schedule.voice_count];
    for (const array::Voice& voice : std::span(schedule.voices).first(schedule.voice_count)) {
      const bool lifting = voice.foci[0].x * x > 0;
      fastest = std::max(fastest, lifting ? 0 : voice.velocity.z);
      slowest = std::min(slowest, lifting ? 1 : voice.velocity.z);
      EXPECT_LT(std::abs(lifting ? voice.velocity.z : voice.velocity.y), 0.03) << "the other finger's";
      EXPECT_FALSE(lifting && schedule.voice_count == 1) << "it is silent, and the other goes on";
      const double way_m = glm::length(voice.velocity) * (late_s - schedule.advance.first_s);
      EXPECT_GE(distances_m[k], way_m - 1e-9) << "the longest way is reported";
    }
  }
  EXPECT_GT(frames_with[1], 10U);
  EXPECT_GT(frames_with[2], 10U);
  EXPECT_GT(fastest, 0.03);
  EXPECT_GE(slowest, -1e-2);
}

INSTANTIATE_TEST_SUITE_P(Sides, PredictFingers, testing::Values(-0.025, 0.025));

/// What the loop says of its slots to a planner.
struct AskingPlanner : test::FakePlanner {
  std::vector<std::optional<FirstSlot>> first;
  void start(const SkinFrame& frame) override {
    test::FakePlanner::start(frame);
    first.push_back(frame.first());
    current.prediction = Prediction{.latency_s = 0.02, .distance_m = 0.004};
  }
};

TEST(PredictLoop, SaysWhenSlotsSoundUnlessFramesWait) {
  for (const bool every_frame : {false, true}) {
    test::SteppedLoop<AskingPlanner> loop;
    loop.source.count = 12;
    loop.source.period_s = 0.01;
    loop.options.every_frame = every_frame;
    loop.run();
    ASSERT_FALSE(loop.planner.first.empty());
    std::uint64_t before = 0;
    for (const auto& first : loop.planner.first) {
      ASSERT_EQ(first.has_value(), !every_frame);
      if (!first) continue;
      EXPECT_GE(first->slot, before);
      EXPECT_GT(first->ahead_s.value(), 0);
      EXPECT_LT(first->ahead_s.value(), 0.1) << "the hold";
      before = first->slot;
    }
    ASSERT_TRUE(loop.stats.prediction);
    EXPECT_EQ(loop.stats.prediction->latency_s.count(), loop.stats.planned);
    EXPECT_CONTAINS(to_json(loop.stats), "\"prediction\"");
    EXPECT_NEAR(loop.stats.prediction->distance_m.quantile(0.5), 0.004, 1e-6);
  }
}

TEST(Ahead, GivesEachSlotItsOwnTimeUpToTheClamp) {
  const double slot_s = 1.5e-3;
  for (const double latency_s : {0.0, 0.01, 0.02, 0.05, 0.06, 0.5}) {
    const Ahead ahead = ahead_of(FirstSlot{7, latency_s}, latency_s, 10, slot_s);
    EXPECT_GE(ahead.foci_s, 0);
    EXPECT_LE(ahead.foci_s, most_ahead_s);
    EXPECT_EQ(ahead.clamped, latency_s + 9 * slot_s > most_ahead_s);
    for (std::uint64_t slot = 0; slot < 200; ++slot) {
      const double at_s = ahead.foci_s + ahead.advance.time_of(slot, slot_s);
      EXPECT_LE(at_s, most_ahead_s + 1e-12);
      EXPECT_GE(at_s, 0);
      if (slot < 7 || slot >= 27) continue;
      const double due_s = latency_s + static_cast<double>(slot - 7) * slot_s;
      EXPECT_NEAR(at_s, std::min(due_s, most_ahead_s), 1e-12) << slot;
    }
  }
  const Ahead standing = ahead_of(std::nullopt, 0.02, 10, slot_s);
  EXPECT_FALSE(standing.advance.moves());
  EXPECT_NEAR(standing.foci_s, 0.02 + 4.5 * slot_s, 1e-12) << "the middle of the cycle";
}

/// The drives of a plan, as planners list them.
Plan plan_of(const array::Layout& layout, array::Schedule schedule, bool lists_standing) {
  Plan plan;
  plan.schedule = std::move(schedule);
  SlotWork work{.lists_standing = lists_standing};
  array::SlotDrives slots;
  drive_on_host(plan, layout, {}, work, nullptr, slots);
  return plan;
}

bool is_drive_for(std::span<const array::TransducerDrive> drive, const array::Layout& layout, const Vec3& focus) {
  const std::vector<array::SlotFocus> foci{{focus, 1.0F}};
  const array::Drive expected = array::drive_for(layout, foci);
  return std::ranges::equal(
      drive, expected, [](const auto& a, const auto& b) { return a.amplitude == b.amplitude && a.phase == b.phase; });
}

TEST(PlanThatAdvances, PlaysEachFocusAtItsTimeAndRepeatsItsSecondCycle) {
  const array::Layout layout = test::small_layout();
  const auto order = array::fill_order(10, 3);
  for (const bool standing : {false, true}) {
    array::Schedule schedule = test::touching(Vec3(0, 0.15, 0));
    array::Voice& voice = schedule.voices[0];
    voice.velocity = Vec3(0.2, 0, 0.1);
    schedule.advance = {.first_slot = 13, .cycle = 10, .cycles = 2, .first_s = -6e-3, .most_s = 15e-3};
    const Plan plan = plan_of(layout, schedule, standing);
    EXPECT_EQ(plan.cycle.length, 10U);
    ASSERT_EQ(plan.listed(), standing ? 30U : 20U);
    ASSERT_EQ(plan.drives.size(), plan.listed() * layout.transducers.size());
    for (std::uint64_t slot = 0; slot < 70; ++slot) {
      // Slots before the first count as those of the first cycle, and the second cycle is repeated.
      const std::uint64_t like = slot < 13 ? slot + (slot < 3 ? 20 : 10) : slot < 23 ? slot : 23 + (slot - 23) % 10;
      const double time_s = std::min(-6e-3 + (static_cast<double>(like) - 13) * 1.5e-3, 15e-3);
      const Vec3 focus = plan.schedule.voices[0].foci[order[slot % 10]] + time_s * voice.velocity;
      EXPECT_TRUE(is_drive_for(plan.drive(slot, layout.transducers.size()), layout, focus)) << slot;
    }
    const PlayedPlan to_link = played(plan, layout.transducers.size(), 13, 80);
    EXPECT_EQ(to_link.slots.cycle.is_listed(), standing) << "a link that plays no plans gets no drives in them";
    if (!standing) continue;
    ASSERT_EQ(to_link.drives.size(), 10 * layout.transducers.size());
    ASSERT_EQ(to_link.foci.size(), 10U);
    for (std::uint64_t slot = 0; slot < 10; ++slot) {
      EXPECT_EQ(to_link.foci[slot], plan.schedule.voices[0].foci[order[slot]]);
      const auto drive = to_link.drives.subspan(slot * layout.transducers.size(), layout.transducers.size());
      EXPECT_TRUE(is_drive_for(drive, layout, plan.schedule.voices[0].foci[order[slot]])) << "the middle of the cycle";
    }
  }
}

TEST(PlanThatAdvances, ListsAFramesSlotsOfASingleFocus) {
  const array::Layout layout = test::small_layout();
  array::Schedule schedule = test::touching(Vec3(0, 0.15, 0), 200);
  array::Voice& voice = schedule.voices[0];
  voice.foci.resize(1);
  voice.order = {0};
  voice.velocity = Vec3(0.2, 0, 0);
  schedule.advance = {.first_slot = 4, .cycle = 1, .first_s = 0, .most_s = 40e-3};
  const Plan plan = plan_of(layout, schedule, true);
  EXPECT_EQ(plan.cycle.length, 1U) << "the output modulates it";
  ASSERT_EQ(plan.listed(), 1 + least_advance_slots);
  for (std::uint64_t slot = 4; slot < 40; ++slot) {
    const double time_s = 1.5e-3 * static_cast<double>(std::min<std::uint64_t>(slot - 4, least_advance_slots - 1));
    const Vec3 focus = plan.schedule.voices[0].foci[0] + time_s * voice.velocity;
    EXPECT_TRUE(is_drive_for(plan.drive(slot, layout.transducers.size()), layout, focus)) << slot;
  }
}

TEST(PlanThatAdvances, StandsIfItsDrivesAreTooMany) {
  array::Schedule schedule = test::touching(Vec3(0, 0.15, 0), 7);  // so slow a modulation makes a long cycle
  const array::Voice first = schedule.voices[0];
  schedule.add_voice() = first;
  schedule.voices[1].modulation_hz = 0;
  for (array::Voice& voice : schedule.voices)
    voice.velocity = Vec3(0.2, 0, 0);
  schedule.advance = {.first_slot = 13, .cycle = 10, .first_s = 0, .most_s = 15e-3};
  const Plan plan = plan_of(test::small_layout(), schedule, true);
  EXPECT_LE(plan.listed(), most_cycle);
  EXPECT_FALSE(plan.cycle.is_listed() && plan.schedule.advance.moves());
}

TEST(SlotClock, KnowsWhenTheNextSlotSounds) {
  const test::SteppedClock clock;
  SlotClock slots(clock, 1.5e-3);
  EXPECT_FALSE(slots.first(0)) << "the output has not begun";
  slots.begin(0);
  clock.sleep(0.0101);
  const auto first = slots.first(-0.0099);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->slot, 7U);
  EXPECT_NEAR(first->ahead_s.value(), 7.5 * 1.5e-3 + 0.0099, 1e-9) << "to the middle of the slot";
}

/// The warnings about frames with these capture times, one every 11 ms.
std::string said_of(const std::vector<double>& times_s) {
  return test::stderr_of([&] {
    CaptureTimes times;
    double arrived_s = 50;
    for (const double time_s : times_s)
      times.see(time_s, arrived_s += 0.011, 0);
  });
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

TEST(CaptureTimes, AreNumbers) {
  CaptureTimes times;
  EXPECT_TRUE(times.is_time(0));
  const std::string said = test::stderr_of([&] {
    for (const double time_s :
         {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
      EXPECT_FALSE(times.is_time(time_s));
  });
  EXPECT_EQ(lines_of(said), 1U) << said;
}

TEST(CaptureTimes, SaysOnceWhatCannotBeACameras) {
  const auto expect_once = [](const std::string& said, const std::string& told) {
    EXPECT_EQ(lines_of(said), told.empty() ? 0U : 1U) << said;
    EXPECT_CONTAINS(said, told);
  };
  expect_once(said_of({1, 1.011, 1.022, 1.022, 1.033, 1.3}), "");  // a pause and a repeated frame are normal
  expect_once(said_of({5, 5.01, 4, 3, 2, 1}), "run backwards (from 5.010 s to 4.000 s)");
  expect_once(said_of({5, 5, 5, 5, 5, 5}), "stand still");
  expect_once(said_of({5, 3605, 7205, 7205.011}), "jump (from 5.000 s to 3605.000 s)");
  expect_once(test::stderr_of([] {
                CaptureTimes times;
                times.see(25.285, 26.34, 0);
                times.see(26.351, 26.37, 0.019);
              }),
              "");  // a frame that waited while palpa started is normal
  expect_once(test::stderr_of([] {
                CaptureTimes times;
                for (int k = 0; k < 40; ++k)  // ten frames at once, every 110 ms
                  times.see(0.011 * k, 0.11 * (k / 10), 0.011 * (10 - k % 10));
              }),
              "late or in bursts");
  expect_once(test::stderr_of([] {
                CaptureTimes times;
                times.see(0);
                times.see(3600);
              }),
              "jump");  // of a recording, too
}

}  // namespace
}  // namespace palpa::session
