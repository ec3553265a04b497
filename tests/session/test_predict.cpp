// Fingers that move, through the whole chain: where foci sound, compared with where the skin then is.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fakes.hpp"
#include "hand_motion.hpp"
#include "predict_chain.hpp"
#include "session/loop/loop.hpp"
#include "session/plan/plan.hpp"
#include "session/predict/capture_times.hpp"
#include "session/predict/predictor.hpp"
#include "session/predict/slot_clock.hpp"
#include "support/captured.hpp"
#include "support/exhaustive.hpp"
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

/// Frames are computed by the twins, or on the tests' device.
class PredictChain : public testing::TestWithParam<bool> {
 protected:
  ChainErrors errors_of(const ChainFilm& film, double late_s) const { return chain_errors(film, late_s, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Backends, PredictChain, testing::Bool(),
                         [](const auto& backend) { return backend.param ? "Device" : "Twin"; });

TEST_P(PredictChain, KeepsFociOnAFingerThatSlides) {
  for (const bool along_z : {false, true}) {
    if (GetParam() && along_z && !test::exhaustive()) continue;
    const ChainErrors errors = errors_of(test::sliding_film(0.2, along_z, 0.3), 0.02);
    SCOPED_TRACE(text_of(errors));
    ASSERT_GT(errors.predicted.slots, 100U);
    EXPECT_GT(errors.seen.mean_m, 4e-3);
    EXPECT_LT(errors.predicted.mean_m, 1.0e-3);
    EXPECT_LT(errors.predicted.p95_m, 2.0e-3);
    EXPECT_EQ(errors.predicted.begun, 0U);
  }
}

/// The truth is where the same session puts the foci without the sensor's noise.
TEST(PredictChainHand, KeepsFociOnTheTrueSkinOfAHandThatSlides) {
  for (const bool along_z : {false, true}) {
    const ChainErrors errors = chain_errors(test::hand_film(0.2, along_z, 0.3), 0.02, false);
    SCOPED_TRACE(text_of(errors));
    ASSERT_GT(errors.predicted.slots, 100U);
    EXPECT_GT(errors.seen.mean_m, 2.3e-3);
    EXPECT_LE(errors.predicted.mean_m, 1.2e-3);
    EXPECT_EQ(errors.predicted.begun, 0U);
  }
}

TEST_P(PredictChain, FollowsTheSurface) {
  if (GetParam() && !test::exhaustive()) return;  // the device sees the same fingers, see above
  const ChainErrors errors = errors_of(test::crossing_film(0.2), 0.02);
  SCOPED_TRACE(text_of(errors));
  ASSERT_GT(errors.predicted.slots, 20U);
  EXPECT_LT(errors.predicted.mean_m, 0.4 * errors.seen.mean_m);
}

TEST_P(PredictChain, EndsWithAFingerThatLiftsAndBeginsNothing) {
  for (const double speed : {0.1, 0.3}) {
    if (GetParam() && speed > 0.2 && !test::exhaustive()) continue;
    const ChainErrors errors = errors_of(test::lifting_film(speed), 0.02);
    SCOPED_TRACE(text_of(errors));
    EXPECT_LE(errors.predicted.late_s, errors.seen.late_s - 0.01) << "a frame and more sooner";
    EXPECT_EQ(errors.predicted.begun, 0U);
    if (GetParam()) continue;  // the device sees the same fingers
    const ChainErrors pressing = errors_of(test::lifting_film(-speed), 0.02);
    EXPECT_EQ(pressing.predicted.begun, 0U);
  }
}

TEST_P(PredictChain, ChangesNothingAtRest) {
  if (GetParam() && !test::exhaustive()) return;  // the device sees the same fingers, see above
  for (const double late_s : {0.01, 0.05}) {
    const ChainErrors errors = errors_of(test::lifting_film(0), late_s);
    SCOPED_TRACE(text_of(errors));
    EXPECT_LE(errors.predicted.p95_step_m, 1.02 * errors.seen.p95_step_m);
    EXPECT_LE(errors.predicted.mean_m, 1.1 * errors.seen.mean_m);
  }
}

/// A hand's own motion, laid over a plate.
TEST(PredictChainRecorded, HalvesTheErrorOfARecordedMotion) {
  PALPA_SHARED_OR_SKIP(data, "hand-motion");
  const test::TipPath tip = test::marker_tips().front();
  double fastest_s = 0, fastest = 0;
  for (double t = tip.begin_s() + 0.5; t < tip.end_s() - 1.5; t += 0.1) {
    double way = 0;
    for (double s = t; s < t + 0.8; s += 0.02)
      way += glm::distance(tip.at(s), tip.at(s + 0.02));
    if (way > fastest) fastest = way, fastest_s = t;
  }
  const Vec3 middle = tip.at(fastest_s);
  const ChainErrors errors = chain_errors({.scene = "plate",
                                           .motion =
                                               [&](double t) {
                                                 // Its fastest directions are up and forward.
                                                 const Vec3 way = tip.at(fastest_s + t) - middle;
                                                 return test::tip_at({way.y, -0.003, glm::clamp(way.z, -0.06, 0.06)});
                                               },
                                           .length_s = 0.8,
                                           .rate_hz = 75},
                                          0.02, false);
  SCOPED_TRACE(text_of(errors));
  ASSERT_GT(errors.predicted.slots, 100U);
  EXPECT_LT(errors.predicted.mean_m, 0.5 * errors.seen.mean_m);
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

TEST(PredictFingers, MoveEachByItself) {
  ChainFilm film = test::lifting_film(0.2);  // at rest for 0.12 s, gone 25 ms later
  const auto lifts = film.motion;
  film.motion = [&](double t) { return glm::translate(Transform(1), Vec3(-0.025, 0, 0)) * lifts(t); };
  film.second = [](double t) { return test::tip_at({0.025, -0.003, t < 0.05 ? 0 : 0.1 * (t - 0.05)}); };
  std::vector<std::uint32_t> frames_with(3);
  double fastest = 0, slowest = 1;
  for (const array::Schedule& schedule :
       test::schedules_of(film, 0.03, [](std::uint64_t k) { return static_cast<double>(k) / 90; })) {
    ASSERT_LE(schedule.voice_count, 2U);
    ++frames_with[schedule.voice_count];
    for (const array::Voice& voice : std::span(schedule.voices).first(schedule.voice_count)) {
      const bool lifting = voice.foci[0].x < 0;
      fastest = std::max(fastest, lifting ? 0 : voice.velocity.z);
      slowest = std::min(slowest, lifting ? 1 : voice.velocity.z);
      EXPECT_LT(std::abs(lifting ? voice.velocity.z : voice.velocity.y), 0.03) << "the other finger's";
      EXPECT_FALSE(lifting && schedule.voice_count == 1) << "it is silent, and the other goes on";
    }
  }
  EXPECT_GT(frames_with[1], 10U);
  EXPECT_GT(frames_with[2], 10U);
  EXPECT_GT(fastest, 0.03);
  EXPECT_GE(slowest, -1e-2);
}

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
    test::FakeSource source;
    source.count = 12;
    source.period_s = 0.01;
    AskingPlanner planner;
    test::SpyLink link;
    std::atomic<bool> stop{false};
    LoopStats stats;
    run_loop(source, planner, link, {.output = {planner.layout, {}, 1.5e-3, 0.1}}, stop, {.every_frame = every_frame},
             stats);
    ASSERT_FALSE(planner.first.empty());
    std::uint64_t before = 0;
    for (const auto& first : planner.first) {
      ASSERT_EQ(first.has_value(), !every_frame);
      if (!first) continue;
      EXPECT_GE(first->slot, before);
      EXPECT_GT(first->ahead_s.value(), 0);
      before = first->slot;
    }
    ASSERT_TRUE(stats.prediction);
    EXPECT_EQ(stats.prediction->latency_s.count(), stats.planned);
    EXPECT_CONTAINS(to_json(stats), "\"prediction\"");
    EXPECT_NEAR(stats.prediction->distance_m.quantile(0.5), 0.004, 1e-6);
  }
}

/// A live run: the latency is what the frames really take.
TEST(PredictLoop, MeasuresTheLatencyOfALiveRun) {
  test::SpyLink link;
  const auto stroke = [](double t) {  // to and fro at 240 mm/s
    const double u = std::fmod(t, 0.4) / 0.4;
    return test::tip_at({0.024 * (u < 0.5 ? 4 * u - 1 : 3 - 4 * u), -0.003, 0});
  };
  const test::LiveRun run = test::live_run(stroke, 70, link);
  EXPECT_TRUE(link.ended_silent());
  ASSERT_TRUE(run.stats.prediction);
  const PredictStats& prediction = *run.stats.prediction;
  // Frames that are planned before the output thread has begun its first slot have no known latency.
  EXPECT_LE(prediction.latency_s.count(), run.stats.touching);
  EXPECT_GE(prediction.latency_s.count() + 5, run.stats.touching);
  EXPECT_GT(prediction.latency_s.quantile(0), 0);
  EXPECT_LE(prediction.distance_m.quantile(1), MotionFilter::most_speed * most_ahead_s);
  EXPECT_EQ(run.begun, 0U);
  if (run.stats.planned < 45) return;  // a machine so busy leaves out too many frames
  EXPECT_GT(prediction.distance_m.quantile(0.9), 0.5e-3);
  EXPECT_LT(prediction.latency_s.quantile(0.5), 0.1);
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
    for (std::uint64_t slot = 0; slot < 10; ++slot) {
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
  const Clock clock;
  SlotClock slots(clock, 1.5e-3);
  EXPECT_FALSE(slots.first(0)) << "the output has not begun";
  slots.begin(clock.now() - 0.0101);
  const double captured_s = clock.now() - 0.02;
  const auto first = slots.first(captured_s);
  ASSERT_TRUE(first);
  EXPECT_GE(first->slot, 7U);
  const double ahead_s = first->ahead_s.value();
  EXPECT_GT(ahead_s, 0.02 + 0.5 * 1.5e-3 - 1e-6) << "not before now";
  EXPECT_NEAR(ahead_s - (static_cast<double>(first->slot) - 7) * 1.5e-3, 0.0211, 2e-3);
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
  EXPECT_EQ(said_of({1, 1.011, 1.022, 1.022, 1.033, 1.3}), "") << "a pause and a repeated frame are normal";
  EXPECT_EQ(test::stderr_of([] {
              CaptureTimes times;
              times.see(25.285, 26.34, 0);
              times.see(26.351, 26.37, 0.019);
            }),
            "")
      << "a frame that waited while palpa started is normal";
  const std::string back = said_of({5, 5.01, 4, 3, 2, 1});
  EXPECT_CONTAINS(back, "run backwards (from 5.010 s to 4.000 s)");
  EXPECT_EQ(lines_of(back), 1U);
  const std::string still = said_of({5, 5, 5, 5, 5, 5});
  EXPECT_CONTAINS(still, "stand still");
  EXPECT_EQ(lines_of(still), 1U);
  const std::string jumps = said_of({5, 3605, 7205, 7205.011});
  EXPECT_CONTAINS(jumps, "jump (from 5.000 s to 3605.000 s)");
  EXPECT_EQ(lines_of(jumps), 1U);
  const std::string bursts = test::stderr_of([] {
    CaptureTimes times;
    for (int k = 0; k < 40; ++k)  // ten frames at once, every 110 ms
      times.see(0.011 * k, 0.11 * (k / 10), 0.011 * (10 - k % 10));
  });
  EXPECT_CONTAINS(bursts, "late or in bursts");
  EXPECT_EQ(lines_of(bursts), 1U);
  EXPECT_CONTAINS(test::stderr_of([] {
                    CaptureTimes times;
                    times.see(0);
                    times.see(3600);
                  }),
                  "jump")
      << "of a recording, too";
}

}  // namespace
}  // namespace palpa::session
