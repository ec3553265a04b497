// The three threads together, with frames, plans and links made by the test.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <thread>
#include <vector>

#include "session/loop/source_clock.hpp"
#include "session/threads.hpp"
#include "stepped_loop.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

using Loop = test::SteppedLoop<>;

TEST(Loop, RunsToTheEndOfItsSourceAndEndsSilent) {
  Loop loop;
  loop.source.count = 30;
  loop.run();
  EXPECT_EQ(loop.stats.captured, 30u);
  EXPECT_EQ(loop.stats.planned + loop.stats.replaced, 30u);
  EXPECT_EQ(loop.stats.touching, loop.stats.planned);
  EXPECT_GT(*std::max_element(loop.link.loudest.begin(), loop.link.loudest.end()), 0.9f);
  EXPECT_TRUE(loop.link.ended_silent());
  EXPECT_EQ(loop.stats.output.drives + 1, loop.link.slots.size());
}

TEST(Loop, LooksAtEveryFramePlaysItAndRecordsItWhenAsked) {
  for (const double recorder_s : {0.0, 3e-3}) {  // a slot is 1.5 ms
    Loop loop;
    loop.source.count = 1'000'000;
    loop.source.period_s = 0;
    loop.options.frames = 25;
    loop.options.every_frame = true;
    loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(1e-4); };
    std::vector<std::uint64_t> all(25), written;
    std::iota(all.begin(), all.end(), 0);
    loop.options.record = [&](const sensing::FrameSet& set) {
      loop.clock.sleep(recorder_s);
      written.push_back(set.sequence);
    };
    loop.run();
    EXPECT_EQ(loop.stats.captured, 25u) << "it stops after the frames asked for";
    EXPECT_EQ(loop.planner.seen, all);
    EXPECT_EQ(written, all);
    EXPECT_EQ(loop.stats.unrecorded, 0u);
    EXPECT_EQ(loop.stats.unplayed, 0u);
    EXPECT_EQ(std::ranges::count(loop.link.plans, 1u, &test::SpyLink::Played::voices), 25);
  }
}

TEST(Loop, TheNewestFrameWinsWhenComputeIsSlow) {
  Loop loop;
  loop.source.count = 60;
  loop.source.period_s = 0.001;
  loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(20e-3); };
  loop.run();
  EXPECT_GT(loop.stats.replaced, 10u);
  EXPECT_TRUE(std::is_sorted(loop.planner.seen.begin(), loop.planner.seen.end()));
  EXPECT_EQ(loop.planner.seen.back(), 59u) << "the last frame is the newest";
}

/// The scheduler slice that the calling thread requests; 0 if the kernel does not report it, before 6.12.
std::uint64_t slice_ns() {
  struct {
    std::uint32_t size = 48, policy = 0;
    std::uint64_t flags = 0;
    std::int32_t nice = 0;
    std::uint32_t priority = 0;
    std::uint64_t slice_ns = 0, deadline_ns = 0, period_ns = 0;
  } has;
  syscall(SYS_sched_getattr, 0, &has, sizeof has, 0U);
  return has.slice_ns;
}

TEST(Loop, DrivesAndTouchGoBeforeTheirSource) {
  const std::uint64_t usual = slice_ns();
  if (usual == 0 || sched_getscheduler(0) != SCHED_OTHER) GTEST_SKIP() << "no slices to ask for";
  struct LookingLink : test::SpyLink {
    std::uint64_t slice = 0;
    Scheduling scheduling = Scheduling::unknown;
    void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
      slice = slice_ns();
      scheduling = scheduling_of(0);
      SpyLink::send(slot, drive);
    }
  } link;
  Loop loop;
  std::uint64_t source = 0, compute = 0, driver = 0, recorder = 0;
  loop.source.before = [&](std::uint64_t) { source = slice_ns(); };
  loop.planner.before = [&](std::uint64_t) { compute = slice_ns(); };
  loop.options.record = [&](const sensing::FrameSet&) { recorder = slice_ns(); };
  std::thread([&] {
    go_first();
    std::thread([&] { driver = slice_ns(); }).join();
    run_loop(loop.source, loop.planner, link, loop.setting, loop.stop, loop.options, loop.stats);
  }).join();
  EXPECT_LT(compute, usual);
  EXPECT_EQ(driver, compute) << "a device's threads are started by the thread that computes on it";
  if (link.scheduling != Scheduling::real_time) {
    EXPECT_EQ(link.slice, compute);
  }
  EXPECT_EQ(loop.stats.output.scheduling, link.scheduling);
  EXPECT_EQ(source, usual);
  EXPECT_EQ(recorder, usual);
  EXPECT_EQ(slice_ns(), usual) << "other threads keep their time slice";
}

TEST(Loop, DrivesLeaveWhileAFrameIsLate) {
  Loop loop;
  loop.source.count = 3;
  loop.setting.output.hold_s = 1.0;
  std::atomic<bool> late{false};
  loop.planner.before = [&](std::uint64_t frame) {
    if (frame != 2) return;
    late = true;
    loop.clock.sleep(0.2);
  };
  loop.watcher.on_planned = [&](const FrameReport&, const Plan&) { loop.stop = late.load(); };
  loop.run();
  ASSERT_TRUE(late);
  EXPECT_GE(loop.stats.output.drives - loop.stats.output.silent_drives, 133u) << "200 ms are 133 slots";
}

TEST(Loop, FallsSilentWhenFramesStopComing) {
  for (const bool every_frame : {false, true}) {
    Loop loop;
    loop.source.count = 4;
    loop.options.every_frame = every_frame;
    loop.setting.output.hold_s = 0.03;
    loop.source.before = [&](std::uint64_t frame) {
      if (frame == 3) loop.clock.sleep(0.2);
    };
    int expired = 0;
    std::uint64_t planned = 0, planned_before = 0;
    loop.watcher.on_planned = [&](const FrameReport&, const Plan&) { ++planned; };
    loop.watcher.on_expired = [&] {
      EXPECT_GT(planned, planned_before) << "once after a frame";
      planned_before = planned;
      ++expired;
    };
    loop.run();
    EXPECT_EQ(expired > 0, !every_frame) << "a source of which every frame is looked at is waited for";
    if (every_frame) continue;
    // Sound, then silence, then sound again.
    int changes = 0;
    for (std::size_t i = 1; i < loop.link.loudest.size(); ++i)
      changes += (loop.link.loudest[i] > 0) != (loop.link.loudest[i - 1] > 0) ? 1 : 0;
    EXPECT_GE(changes, 3);
    EXPECT_TRUE(std::ranges::any_of(loop.link.plans, [](const auto& plan) { return plan.voices == 0; }));
  }
}

TEST(Loop, AfterAnErrorThereIsNoRampAndNoHold) {
  enum class Fault { camera, planner, disk };
  for (const Fault fault : {Fault::camera, Fault::planner, Fault::disk}) {
    Loop loop;
    loop.source.count = 1'000'000;
    loop.setting.output.hold_s = 5;
    loop.setting.output.safety.ramp_s = most_ramp_s;
    const auto fail = [&](std::uint64_t frame) {
      if (frame >= 20) throw failure("it broke");  // frame 20 itself may be left out
    };
    if (fault == Fault::camera) loop.source.before = fail;
    if (fault == Fault::planner) loop.planner.before = fail;
    if (fault == Fault::disk) loop.options.record = [&](const sensing::FrameSet& set) { fail(set.sequence); };
    EXPECT_EQ(loop.fault(), "it broke");
    EXPECT_TRUE(loop.link.ended_silent());
    EXPECT_TRUE(loop.link.finished);
    // Twenty frames are 40 ms or 27 drives; the ramp down would be 334 drives and the hold 3333.
    EXPECT_LT(loop.link.slots.size(), 32u) << static_cast<int>(fault);
  }
}

TEST(Loop, TellsOfEachFrameThatHasComeBeforeItIsPlanned) {
  Loop loop;
  loop.source.count = 30;
  std::atomic<std::uint64_t> arrived{0};
  loop.watcher.on_arrived = [&](std::uint64_t sequence) {
    loop.clock.sleep(1e-3);
    EXPECT_EQ(sequence, arrived++);
  };
  loop.watcher.on_planned = [&](const FrameReport& report, const Plan&) { EXPECT_LT(report.sequence, arrived); };
  loop.run();
  EXPECT_EQ(arrived, 30u);
}

TEST(Loop, FallsSilentWhenTheHandLeaves) {
  Loop loop;
  loop.source.count = 60;
  loop.setting.output.hold_s = 10;
  loop.planner.fingers = [](std::uint64_t frame) { return frame < 20 ? 1u : 0u; };
  loop.options.every_frame = true;
  loop.watcher.on_planned = [&](const FrameReport& report, const Plan&) { loop.stop = report.sequence == 59; };
  loop.run();
  const auto loud = std::find_if(loop.link.loudest.rbegin(), loop.link.loudest.rend(), [](float a) { return a > 0; });
  EXPECT_GT(std::distance(loop.link.loudest.rbegin(), loud), 5) << "the hold must not keep a hand that has left";
}

TEST(Loop, ABrokenLinkEndsTheLoopAndIsReported) {
  Loop loop;
  loop.source.count = 1'000'000;
  loop.link.fail_at = 20;
  EXPECT_EQ(loop.fault(), "spy: the link broke");
  EXPECT_TRUE(loop.link.ended_silent());
}

TEST(Loop, GoesDownTheRampBeforeItEnds) {
  Loop loop;
  loop.source.count = 1'000'000;
  loop.setting.output.safety = {.ceiling = 0.5, .ramp_s = 30e-3};
  // When the ramp is at its top, however long that takes.
  loop.watcher.on_planned = [&](const FrameReport&, const Plan&) { loop.stop = loop.link.most > 0.499f; };
  loop.run();
  const std::vector<float>& heard = loop.link.loudest;
  EXPECT_NEAR(*std::max_element(heard.begin(), heard.end()), 0.5, 1e-6);
  float last = 0;
  for (const float loud : heard) {
    EXPECT_NEAR(loud, last, 0.03) << "a step of 1/20 of the ceiling";
    last = loud;
  }
  EXPECT_TRUE(loop.link.ended_silent());
  EXPECT_TRUE(loop.link.finished);
}

/// Frames come every 3 ms, and it takes this long to record one.
struct SlowlyRecordedLoop : Loop {
  std::vector<std::uint64_t> written;

  explicit SlowlyRecordedLoop(double takes_s, std::uint64_t room_bytes = 1 << 20) {
    source.count = 40;
    source.period_s = 0.003;
    options.record_waiting_bytes = room_bytes;
    options.record = [this, takes_s](const sensing::FrameSet& set) {
      clock.sleep(takes_s);
      written.push_back(set.sequence);
    };
  }
};

TEST(Loop, ASlowRecorderDelaysNoTouchAndSaysWhatItLeftOut) {
  SlowlyRecordedLoop loop(30e-3, 0);
  loop.run();
  EXPECT_GT(loop.stats.unrecorded, 10u);
  EXPECT_EQ(loop.written.size() + loop.stats.unrecorded, 40u);
  EXPECT_EQ(loop.written.back(), 39u);
  EXPECT_GT(loop.stats.planned, 2 * loop.written.size());
}

TEST(Loop, FramesWaitForASlowRecorderIfThereIsRoom) {
  SlowlyRecordedLoop loop(10e-3);
  std::vector<std::uint64_t> rest;
  loop.watcher.on_recording_rest = [&](std::uint64_t frames) { rest.push_back(frames); };
  loop.run();
  EXPECT_EQ(loop.stats.unrecorded, 0u);
  ASSERT_EQ(loop.written.size(), 40u);
  EXPECT_TRUE(std::ranges::is_sorted(loop.written));
  ASSERT_FALSE(rest.empty()) << "the loop ends before its recording";
  EXPECT_EQ(rest.back(), 1u);
  EXPECT_TRUE(std::ranges::is_sorted(rest, std::greater<>()));
}

TEST(Loop, StopsWhenToldAndLosesFramesThatWaitForARecorder) {
  SlowlyRecordedLoop loop(50e-3);
  loop.source.count = 1'000'000;
  loop.stop_at(0.3);
  loop.run();
  EXPECT_TRUE(loop.link.ended_silent());
  EXPECT_LE(loop.link.slots.size(), 203u) << "300 ms are 200 slots; one more is silent";
  EXPECT_LT(loop.source.given, 105u) << "a frame comes every 3 ms";
  EXPECT_GT(loop.stats.unrecorded, 10u);
  EXPECT_EQ(loop.written.size() + loop.stats.unrecorded, loop.stats.captured);
  EXPECT_LT(loop.clock.now(), 0.7) << "it has a second to end, whatever waits";
}

TEST(Loop, SoundsWhileItLooksAtEveryFrameOfASourceSlowerThanItsClock) {
  Loop loop;
  loop.source.count = 40;
  loop.source.period_s = 0.01;
  loop.source.clock_rate = 0.1;  // replayed at a tenth of its speed
  loop.options.every_frame = true;
  loop.run();
  EXPECT_LT(loop.stats.output.silent_drives * 3, loop.stats.output.drives);
}

TEST(Loop, SoundsOnWhenTheSourcesClockIsReset) {
  Loop loop;
  loop.source.count = 100;
  loop.source.reset_at = 20;
  double oldest_s = 0;
  loop.watcher.on_planned = [&](const FrameReport& report, const Plan& plan) {
    oldest_s = std::max(oldest_s, report.arrived_s - plan.captured_s);
  };
  loop.run();
  EXPECT_LT(oldest_s, 50);
  EXPECT_LT(loop.stats.output.silent_drives * 3, loop.stats.output.drives);
}

TEST(SourceClock, KnowsAFramesAge) {
  SourceClock clock;
  EXPECT_DOUBLE_EQ(clock.capture_time(100.0, 5.0), 5.0);
  EXPECT_NEAR(clock.capture_time(100.011, 5.011), 5.011, 1e-4);
  EXPECT_NEAR(clock.capture_time(100.022, 5.072), 5.022, 1e-4) << "50 ms late";
  EXPECT_NEAR(clock.capture_time(100.033, 5.033), 5.033, 1e-4);
}

TEST(SourceClock, FollowsAClockThatRunsSlow) {
  SourceClock clock;
  double age = 0;
  for (int i = 0; i < 90 * 3600; ++i) {  // an hour at 50 parts in a million
    const double arrived = i / 90.0;
    age = arrived - clock.capture_time(arrived * (1 - 50e-6), arrived);
  }
  EXPECT_LT(age, 1e-3);
}

/// The first samples of an hour count as much as the last ones, for any unit.
TEST(Stats, QuantilesAreThoseOfTheWholeRun) {
  for (const double unit : {1e-6, 1.0, 1e4}) {
    Samples samples;
    constexpr int count = 300'000;
    for (int i = 0; i < count; ++i)
      samples.add(i < count / 2 ? unit : unit * (1 + 2.0 * i / count));
    EXPECT_EQ(samples.count(), static_cast<std::uint64_t>(count));
    EXPECT_EQ(samples.quantile(0), unit);
    EXPECT_NEAR(samples.quantile(0.4) / unit, 1, 0.003);
    for (const double p : {0.6, 0.99, 0.999})
      EXPECT_NEAR(samples.quantile(p) / unit / (1 + 2 * p), 1, 0.003) << p;
  }
}

TEST(Stats, QuantilesAndJson) {
  Samples samples;
  for (int i = 100; i >= 0; --i)
    samples.add(i);
  EXPECT_NEAR(samples.quantile(0.5), 50.0, 0.003 * 50);
  EXPECT_NEAR(samples.quantile(0.99), 99.0, 0.003 * 99);
  EXPECT_EQ(samples.quantile(0.0), 0.0);
  EXPECT_EQ(samples.quantile(1.0), 100.0);
  EXPECT_EQ(Samples().quantile(0.5), 0.0);
  LoopStats stats;
  const gpu::PassTime times[]{{"skin", 1.0}, {"contacts", 2.0}};
  stats.add_passes(times);
  stats.add_passes(times);
  stats.captured = 7;
  stats.seconds = 1.0 / 3;
  stats.output.sent(0.00123456789, true);
  const std::string none = R"({"count":0,"median":0,"p99":0,"p999":0,"max":0})";
  EXPECT_EQ(to_json(stats),
            R"({"frames":{"captured":7,"replaced":0,"missing":0,"unrecorded":0,"planned":0,"unplayed":0,"touching":0},)"
            "\n \"seconds\":0.333333,\n"
            R"( "timing_ms":{"frame_to_plan":)" +
                none + R"(,"capture_to_drive":)" + none +
                R"(,"drive_jitter":{"count":1,"median":1.23457,"p99":1.23457,"p999":1.23457,"max":1.23457}},)"
                "\n"
                R"( "passes_ms":{"skin":{"count":2,"median":1,"p99":1,"p999":1,"max":1},)"
                R"("contacts":{"count":2,"median":2,"p99":2,"p999":2,"max":2}},)"
                "\n"
                R"( "drives":{"sent":1,"silent":1,"skipped_slots":0},)"
                "\n"
                R"( "hand_over":{"drives":{"loop":0}}})"
                "\n");
}

TEST(Stats, EveryReasonForWhichPointsAreNoSkinIsNamed) {
  using sensing::NoSkin;
  const std::pair<NoSkin, std::string> reasons[]{{NoSkin::room, "outside the room"},
                                                 {NoSkin::board, "on the array's boards"},
                                                 {NoSkin::screen, "on the screen"},
                                                 {NoSkin::background, "in the background"}};
  const std::string begin = "points that are no skin, in a frame on average: ";
  sensing::Dropped all;
  ASSERT_EQ(all.counts.size(), std::size(reasons));
  std::string in_all;
  for (const auto& [why, where] : reasons) {
    sensing::Dropped one;
    one.counts[static_cast<std::size_t>(why)] = 19;
    EXPECT_EQ(to_text(one, 10), begin + "2 " + where + "\n");
    const std::size_t count = 10 * (all.total() + 1);
    all.counts[static_cast<std::size_t>(why)] = count;
    in_all += (in_all.empty() ? "" : ", ") + fmt::format("{} {}", count / 10, where);
  }
  EXPECT_EQ(to_text(all, 10), begin + in_all + "\n");
  EXPECT_EQ(to_text(sensing::Dropped{}, 10), "");
  EXPECT_EQ(to_text(all, 0), "");
  EXPECT_EQ(to_text({}, 10), "");
}

TEST(Stats, EachQuantileHasItsOwnName) {
  LoopStats stats;
  Samples& samples = stats.frame_to_plan_s;
  for (int i = 0; i < 2000; ++i)
    samples.add(1e-3 * i);
  const auto at = [&](double p) { return fmt::format("{:.6g}", 1e3 * samples.quantile(p)); };
  const std::string times =
      fmt::format(R"({{"count":2000,"median":{},"p99":{},"p999":{},"max":{}}})", at(0.5), at(0.99), at(0.999), at(1));
  EXPECT_CONTAINS(to_json(stats), R"("frame_to_plan":)" + times);
  EXPECT_NE(at(0.99), at(0.999));
}

}  // namespace
}  // namespace palpa::session
