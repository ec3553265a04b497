// Strides that follow the array's field, which a background thread computes.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <iterator>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fakes.hpp"
#include "sensing/synthetic.hpp"
#include "session/plan/tuning_thread.hpp"
#include "session/session.hpp"
#include "support/begins.hpp"
#include "support/instrumented.hpp"
#include "support/time_limits.hpp"
#include "touch/stage.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

constexpr double pi = std::numbers::pi;

/// Thirteen foci of 2 ms on the cube: from 1 to 5 mm deep, the stride for spots differs from that for this array's
/// foci.
ScheduleOptions tuned() {
  ScheduleOptions options;
  options.voice.dwell_s = 2e-3;
  options.tune = Tune::stride;
  return options;
}
const touch::FingerOptions thirteen{.foci = 13};
/// At a depth of 3 mm; the default stride is 4.
constexpr std::uint32_t of_spots = 5, of_array = 4;

std::uint32_t stride_of(const array::Schedule& schedule, std::size_t voice = 0) {
  return schedule.voices.at(voice).order.at(1);
}

/// A finger in the cube, as a frame shows it.
touch::Touch finger(const touch::FingerOptions& parameters = thirteen) {
  touch::Touch touch;
  const std::vector<geometry::Solid> solids = test::asset_solids("cube");
  touch::Stage(solids, {}, {.parameters = parameters}).touch(sensing::numbered(test::finger_at({0, -3e-3, 0})), touch);
  return touch;
}

TEST(Tuning, ChangesTheStrideAlone) {
  const touch::Touch touch = finger({});
  const auto voice_of = [&](Tune tune, touch::Method method) {
    array::Schedule schedule;
    Scheduler("cube.glb", test::asset_solids("cube"), {},
              {.method = {.method = method}, .voice = {.stride = 1}, .tune = tune})
        .make(touch, 0, schedule);
    return schedule.voices.at(0);
  };
  const array::Voice tuned = voice_of(Tune::stride, touch::Method::cross_section);
  // The cube's cross-section is about 30 mm around: 200 Hz is felt best.
  EXPECT_EQ(tuned.order, array::fill_order(10, 3));
  EXPECT_EQ(tuned.foci.size(), 10u);
  EXPECT_EQ(tuned.dwell_s, 1.5e-3);
  EXPECT_EQ(voice_of(Tune::stride, touch::Method::multi_focus).foci_per_slot, 10u) << "nothing moves";
  EXPECT_EQ(voice_of(Tune::nothing, touch::Method::cross_section).order, array::fill_order(10, 1));
}

TEST(Tuning, ChangesTheStrideOfEachFingerWhenTheFieldIsReady) {
  const array::Layout layout = test::posed_openmpd();
  const acoustics::ArrayField field(layout, {});
  touch::Touch touch = finger();
  touch.fingers.assign(3, touch::Finger(touch.fingers.at(0)));
  touch.finger_count = 3;
  for (std::uint32_t f = 0; const std::uint32_t id : {3u, 4u, 9u})
    touch.fingers[f++].id = id;
  Scheduler scheduler("cube.glb", test::asset_solids("cube"), thirteen, tuned());
  array::Schedule schedule;
  const auto strides = [&] {
    return std::vector<std::uint32_t>{stride_of(schedule, 0), stride_of(schedule, 1), stride_of(schedule, 2)};
  };
  const std::vector<std::uint32_t> before(3, of_spots), after(3, of_array);
  scheduler.tune_beside(&field);
  scheduler.make(touch, 0, schedule);
  EXPECT_EQ(strides(), before) << "no frame waits for the field";
  double time_s = 0;
  EXPECT_TRUE(test::begins([&] {
    scheduler.make(touch, time_s += 0.011, schedule);
    return strides() == after;
  }));
  scheduler.tune_beside(nullptr);
  for (int frame = 0; frame < 100; ++frame) {
    scheduler.make(touch, time_s += 0.011, schedule);
    EXPECT_EQ(strides(), after) << "and stays, for what is known is known";
  }
}

/// As many transducers and foci as are allowed: their field takes seconds.
struct Long {
  array::Layout layout;
  std::vector<Vec3> foci;
  Long() {
    for (std::uint32_t n = 0; n < array::max_transducers; ++n)
      layout.transducers.push_back({{0.01 * (n % 256), -0.5, 0.01 * (n / 256)}, {0, 1, 0}});
    for (std::uint32_t n = 0; n < touch::max_foci; ++n) {
      const double angle = 2 * pi * n / touch::max_foci;
      foci.emplace_back(0.1 * std::cos(angle), 0, 0.1 * std::sin(angle));
    }
  }
};

TEST(TuningThread, NeitherKeepsAFrameNorTheEnd) {
  const Long heavy;
  const acoustics::ArrayField field(heavy.layout, {});
  const acoustics::Ring ring{0.2 * pi, touch::max_foci, 3, 1.5e-3};
  acoustics::StrideTuner strides;
  double end = 0;
  {
    TuningThread beside(field);
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
      beside.begin(strides);
      for (std::uint32_t id = 0; id < 8; ++id) {
        strides.stride_for(id, ring, 0.01 * frame);
        beside.look_at(id, heavy.foci, false, 0.01 * frame, strides);
      }
      beside.end();
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
    // At the last frame's time, something that was learned in this film would still rest.
    EXPECT_TRUE(strides.wants(0, 0.19)) << "no frame waits for it";
    end = test::processor_s();
  }
  // Processor time, because other programs may hold it up on a busy machine. Eight fingers' fields take many times as
  // much.
  EXPECT_LT(test::processor_s() - end, test::instrumented() ? 4 : 1) << "in the middle of a question";
}

std::set<pid_t> threads() {
  std::set<pid_t> ids;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
    ids.insert(std::stoi(entry.path().filename().string()));
  return ids;
}

/// The policy and niceness of the thread of a TuningThread that is started here, after it has changed its niceness.
std::pair<int, int> urgency_of_a_tuning_thread() {
  const array::Layout layout = test::posed_openmpd();
  const acoustics::ArrayField field(layout, {});
  const std::set<pid_t> before = threads();
  const int nice = getpriority(PRIO_PROCESS, 0);
  const TuningThread beside(field);
  const std::set<pid_t> now = threads();
  std::vector<pid_t> added;
  std::ranges::set_difference(now, before, std::back_inserter(added));
  if (added.size() != 1) return {-1, -1};
  const auto id = static_cast<id_t>(added[0]);
  test::begins([&] { return getpriority(PRIO_PROCESS, id) != nice; });
  return {sched_getscheduler(added[0]), getpriority(PRIO_PROCESS, id)};
}

TEST(TuningThread, GivesWayToWhoStartedIt) {
  const sched_param none{}, urgent{.sched_priority = 1};
  std::pair<int, int> usual, of_nicer, of_real_time;
  bool policies = false, real_time = false;
  int nice = 0;
  // Each thread has its own niceness and policy.
  std::thread([&] {
    policies = sched_setscheduler(0, SCHED_BATCH, &none) == 0 && sched_setscheduler(0, SCHED_OTHER, &none) == 0;
    if (!policies) return;
    nice = getpriority(PRIO_PROCESS, 0);
    usual = urgency_of_a_tuning_thread();
    real_time = sched_setscheduler(0, SCHED_FIFO, &urgent) == 0;
    if (real_time) of_real_time = urgency_of_a_tuning_thread();
    sched_setscheduler(0, SCHED_OTHER, &none);
    setpriority(PRIO_PROCESS, 0, std::min(nice + 3, 19));
    of_nicer = urgency_of_a_tuning_thread();
  }).join();
  if (!policies) GTEST_SKIP() << "skipped: policies cannot be changed here";
  if (nice + 13 > 19) GTEST_SKIP() << "skipped: the niceness of the test itself is too high";
  EXPECT_EQ(usual, std::pair(SCHED_BATCH, nice + 10));
  EXPECT_EQ(of_nicer, std::pair(SCHED_BATCH, nice + 13)) << "ten more than the niceness of the thread that starts it";
  if (!real_time) GTEST_SKIP() << "skipped in part: no real-time threads are allowed here";
  EXPECT_EQ(of_real_time, std::pair(SCHED_BATCH, nice + 10));
}

/// A cube over this array, with a finger in it that does not change, so the result for spots never changes.
struct Live {
  SessionSetting setting{.solids = test::asset_solids("cube"),
                         .cameras = test::paper_cameras(),
                         .layout = test::posed_openmpd(),
                         .touch = thirteen,
                         .schedule = tuned()};
  std::unique_ptr<sensing::DepthSource> source;
  test::SpyLink link;
  std::atomic<bool> stop{false};
  std::vector<std::uint32_t> strides;  ///< frame by frame
  test::Watcher watcher;
  RunOptions options{.observer = &watcher};

  Live(std::uint64_t frames, bool every_frame) {
    const auto still = [](double) { return glm::translate(Transform(1), Vec3(0, -0.003, 0)); };
    source = sensing::make_synthetic_source(
        setting.cameras, test::finger_skin().mesh, {},
        {.motion = still, .noise = sensing::Noise::none, .paced = !every_frame, .frames = frames});
    options.every_frame = every_frame;
    watcher.on_planned = [this](const FrameReport&, const Plan& plan) { strides.push_back(stride_of(plan.schedule)); };
  }
  bool changed() const { return std::ranges::adjacent_find(strides, std::not_equal_to()) != strides.end(); }
  LoopStats run() { return Session(setting).run(*source, link, stop, options); }
};

TEST(Tuning, OfALoopChangesWhileItSounds) {
  Live live(200000, false);  // it ends as soon as it has sounded and the field is there, however long that takes
  live.setting.hold_s = 10;  // no frame is late: with fewer foci, strides would differ
  live.watcher.on_planned = [&, look = live.watcher.on_planned](const FrameReport& report, const Plan& plan) {
    look(report, plan);
    if (live.changed() && live.link.most > 0) live.stop = true;
  };
  const LoopStats stats = live.run();
  EXPECT_TRUE(live.stop) << "the field was never ready";
  EXPECT_TRUE(stats.tune.value().of_array);
  EXPECT_GE(stats.tune->fields, 1u);
  EXPECT_GT(live.link.most, 0.0F);
  EXPECT_TRUE(live.link.ended_silent());
}

TEST(Tuning, OfEveryFrameIsThatOfSpots) {
  Live live(16, true);
  const LoopStats stats = live.run();
  EXPECT_FALSE(stats.tune.value().of_array);
  ASSERT_EQ(live.strides.size(), 16u);
  EXPECT_FALSE(live.changed());
  Live spot(16, false);
  spot.setting.schedule.spot_m = acoustics::SpectrumOptions().fwhm_m;
  EXPECT_FALSE(spot.run().tune.value().of_array);
  EXPECT_FALSE(spot.changed()) << "the array is not asked if a spot replaces it";
  EXPECT_EQ(spot.strides.front(), live.strides.front());
}

}  // namespace
}  // namespace palpa::session
