// The number of drives that passed each hand-over, the normal range, and a single report if it is exceeded; whether
// the array sounds by these numbers.
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "fakes.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/link.hpp"
#include "session/links/safe_link.hpp"
#include "session/watch/sound_watch.hpp"
#include "session/watch/stats.hpp"
#include "support/captured.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::session {
namespace {

using namespace std::chrono_literals;
constexpr SoundWatch::Clock::time_point begin{std::chrono::hours(1)};

/// The counts of a board that took this many of `loop` drives.
HandOver counts(std::uint64_t loop, std::uint64_t completed, std::uint64_t starting = 0) {
  return {.loop = {.drives = loop},
          .behind = Carried{.guard = Passed{.drives = completed},
                            .submitted = {.drives = completed},
                            .completed = {.drives = completed},
                            .starting = starting}};
}

TEST(HandOver, EightDrivesAndTwoPercentAreNormal) {
  EXPECT_EQ(counts(680, 452).lost(), 228u);
  EXPECT_TRUE(counts(680, 452).unusual());
  EXPECT_TRUE(counts(2721, 2446).unusual());
  EXPECT_EQ(counts(1000, 972).normal(), 28u);
  EXPECT_FALSE(counts(1000, 972).unusual());
  EXPECT_TRUE(counts(1000, 971).unusual());
  EXPECT_FALSE(counts(8, 0).unusual()) << "a short run";
  EXPECT_TRUE(counts(9, 0).unusual());
  EXPECT_FALSE(counts(0, 0).unusual());
}

TEST(HandOver, DrivesBeforeTheFirstPlanOfATouchAreNotLost) {
  EXPECT_EQ(counts(100, 60, 40).lost(), 0u);
  EXPECT_EQ(counts(100, 60, 30).lost(), 10u);
}

TEST(HandOver, ALinkThatDoesNotCountHasLostNothingThatIsKnown) {
  const HandOver unknown{.loop = {.drives = 100}};
  EXPECT_EQ(unknown.lost(), 0u);
  EXPECT_CONTAINS(to_text(unknown), "100 drives sounded");
  EXPECT_CONTAINS(to_text(unknown), "does not report");
}

TEST(HandOver, WhatIsLostIsToldOnceWithEachHandOver) {
  HandOverWatch watch;
  EXPECT_EQ(test::stderr_of([&] { watch.look(counts(1000, 990)); }), "");
  HandOver bad = counts(680, 452);
  bad.behind->guard->drives = 500;
  bad.behind->submitted.drives = 460;
  const std::string said = test::stderr_of([&] {
    watch.look(bad);
    watch.look(bad);
  });
  EXPECT_CONTAINS(said, "228 of 680 drives were lost between loop and device; at most 21 are normal");
  EXPECT_CONTAINS(said, "500 were taken by the guard, 460 were submitted to the board, 452 were completed");
  EXPECT_EQ(said.find("lost"), said.rfind("lost")) << "once: " << said;
}

TEST(HandOver, OnlyAGuardWithoutRealTimeSchedulingIsAdvisedToGetIt) {
  HandOver late = counts(680, 452);
  late.behind->guard->drives = 452;
  for (const Scheduling had : {Scheduling::normal, Scheduling::real_time}) {
    late.behind->guard_scheduling = had;
    HandOverWatch watch;
    const std::string said = test::stderr_of([&] { watch.end(late); });
    EXPECT_CONTAINS(said, "palpa-guard got no processor in time");
    EXPECT_EQ(said.find("real-time") == std::string::npos, had == Scheduling::real_time) << said;
  }
}

/// A longer --dwell helps no device that is not there.
TEST(HandOver, DrivesThatADeadDeviceLostHaveTheirOwnRemedy) {
  const auto said_of = [](const std::vector<HandOver>& seconds, bool at_the_end) {
    HandOverWatch watch;
    return test::stderr_of([&] {
      for (const HandOver& one : seconds)
        &one == &seconds.back() && at_the_end ? watch.end(one) : watch.look(one);
    });
  };
  // It dies within the second second.
  const std::vector<HandOver> dies{counts(600, 600), counts(1200, 900), counts(1800, 900)};
  EXPECT_CONTAINS(said_of(dies, false), "900 of 1800 drives were lost between loop and device");
  EXPECT_CONTAINS(said_of(dies, false), "see whether it is plugged in and switched on, and its server runs");
  EXPECT_EQ(said_of(dies, false).find("--dwell"), std::string::npos);
  // At the end, the link knows.
  std::vector<HandOver> ends{counts(600, 600), counts(1200, 900)};
  EXPECT_CONTAINS(said_of(ends, true), "--dwell");
  ends.back().behind->out_of_reach = true;
  EXPECT_EQ(said_of(ends, true).find("--dwell"), std::string::npos);
  // One that is slow, and takes some all the time.
  EXPECT_CONTAINS(said_of({counts(600, 300), counts(1200, 600), counts(1800, 900)}, true), "--dwell");
  // Nobody listens, from the start.
  const HandOver nobody{.loop = {.drives = 60}, .behind = Carried{}};
  EXPECT_CONTAINS(said_of({nobody}, false), "nobody took any; see whether the receiver runs");
}

TEST(HandOver, AreInTheStatistics) {
  LoopStats stats;
  stats.output.hand_over = counts(680, 452, 10);
  EXPECT_CONTAINS(to_json(stats),
                  R"("hand_over":{"drives":{"loop":680,"guard":452,"submitted":452,"completed":452,"starting":10,)"
                  R"("lost":218}})");
  stats.output.hand_over.loop.plans = 90;
  stats.output.hand_over.behind->completed.plans = 80;
  EXPECT_CONTAINS(to_json(stats), R"("plans":{"loop":90,"guard":0,"submitted":0,"completed":80})");
  stats.output.hand_over = {.loop = {.drives = 5}, .behind = Carried{.completed = {.drives = 4}}};
  EXPECT_CONTAINS(to_json(stats), R"("hand_over":{"drives":{"loop":5,"played":4,"lost":1}})");
}

TEST(HandOver, LinksThatAreNoBoardsCountWhatTheyPlayed) {
  const array::Layout layout = test::small_layout();
  const std::vector<std::string> names;
  const test::UdpReceiver receiver(std::chrono::milliseconds(50));
  const auto file = test::scratch_folder("hand-over") / "drives.bin";
  for (const std::string& spec : {std::string("null"), "record:" + file.string(), "foci:" + receiver.address()}) {
    const auto link = open_link(spec, builtin_links(), {layout, names});
    SafeLink safe(*link, layout.transducers.size());
    array::Schedule schedule = test::touching(Vec3(0, 0.15, 0));
    const array::Drive sounding(layout.transducers.size(), {0.5f, 0.0f}), silent(layout.transducers.size(), {0, 0});
    safe.plan({.schedule = schedule, .slots = {.until = 9}});
    for (std::uint64_t slot = 0; slot < 7; ++slot)
      safe.send(slot, slot < 5 ? sounding : silent);
    safe.finish();
    const HandOver passed = safe.handed_over();
    EXPECT_EQ(passed.loop.drives, 5u) << spec;
    EXPECT_EQ(passed.loop.plans, 1u) << spec;
    ASSERT_TRUE(passed.behind) << spec;
    EXPECT_FALSE(passed.behind->guard) << spec;
    EXPECT_EQ(passed.behind->completed.drives, 5u) << spec;
    EXPECT_EQ(passed.lost(), 0u) << spec;
  }
}

TEST(HandOver, WhatFadesAndWhatACeilingMutesIsCountedAsItLeaves) {
  test::SpyLink spy;
  SafeLink safe(spy, 16, {.ramp_s = 6e-3});
  const array::Drive sounding(16, {1.0f, 0.0f}), silent(16, {0, 0});
  array::Schedule schedule = test::touching(Vec3(0, 0.15, 0)), nothing;
  safe.plan({.schedule = schedule, .slots = {.until = 9}});
  for (std::uint64_t slot = 0; slot < 5; ++slot)
    safe.send(slot, sounding);
  safe.plan({.schedule = nothing});
  for (std::uint64_t slot = 5; slot < 12; ++slot)
    safe.send(slot, silent);
  EXPECT_EQ(safe.handed_over().loop.drives, 5u + 3u) << "the way down sounds, too";
  EXPECT_FALSE(safe.handed_over().behind) << "the spy does not count";
  test::SpyLink deaf;
  SafeLink muted(deaf, 16, {.ceiling = 0});
  muted.send(0, sounding);
  EXPECT_EQ(muted.handed_over().loop.drives, 0u);
}

/// A modulation has silent drives between those that sound, and no display may flicker.
TEST(SoundWatch, SoundsUntilNothingHasSoundedForAWhile) {
  SoundWatch watch;
  EXPECT_FALSE(watch.sounding(begin));
  watch.sent(false, std::nullopt, begin);
  EXPECT_FALSE(watch.sounding(begin));
  watch.sent(true, std::nullopt, begin);
  watch.sent(false, std::nullopt, begin + 2ms);
  EXPECT_TRUE(watch.sounding(begin + 60ms));
  EXPECT_FALSE(watch.sounding(begin + 140ms));
  watch.sent(true, std::nullopt, begin + 150ms);
  watch.close();
  EXPECT_FALSE(watch.sounding(begin + 150ms)) << "the run is over";
  EXPECT_FALSE(watch.stuck(begin + 150ms));
}

/// What sounds is what arrived, not what left.
TEST(SoundWatch, ABoardThatTakesNothingMaySound) {
  SoundWatch watch;
  Carried carried;
  const auto plays = [&](std::chrono::milliseconds from, std::chrono::milliseconds to, bool takes) {
    for (auto at = from; at < to; at += 2ms) {
      carried.completed.drives += takes ? 1 : 0;
      watch.sent(true, carried, begin + at);
    }
  };
  plays(0ms, 50ms, true);
  EXPECT_TRUE(watch.sounding(begin + 50ms));
  EXPECT_FALSE(watch.stuck(begin + 50ms));
  plays(50ms, 140ms, false);
  EXPECT_FALSE(watch.stuck(begin + 140ms)) << "drives may be under way";
  plays(140ms, 300ms, false);
  EXPECT_FALSE(watch.sounding(begin + 300ms));
  EXPECT_TRUE(watch.stuck(begin + 300ms));
  watch.sent(false, carried, begin + 450ms);
  EXPECT_FALSE(watch.stuck(begin + 450ms)) << "nothing is to sound";
  plays(455ms, 456ms, false);
  EXPECT_FALSE(watch.stuck(begin + 456ms)) << "this sound has only begun";
  plays(460ms, 470ms, true);
  EXPECT_TRUE(watch.sounding(begin + 470ms)) << "it is plugged in again";
  EXPECT_FALSE(watch.stuck(begin + 470ms));
  carried.out_of_reach = true;
  watch.sent(false, carried, begin + 480ms);
  EXPECT_TRUE(watch.stuck(begin + 10s)) << "it may still play what it has";
  carried.out_of_reach = false;
  watch.sent(false, carried, begin + 11s);
  EXPECT_FALSE(watch.stuck(begin + 11s));
  SoundWatch quiet;
  Carried none;
  none.out_of_reach = true;
  quiet.sent(false, none, begin);
  EXPECT_FALSE(quiet.stuck(begin)) << "nothing has sounded";
}

}  // namespace
}  // namespace palpa::session
