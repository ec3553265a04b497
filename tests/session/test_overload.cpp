// A loop whose frames take longer than the time between them, and longer than they sound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "session/loop/early_start.hpp"
#include "session/loop/slow_solver.hpp"
#include "session/watch/effort.hpp"
#include "stepped_loop.hpp"
#include "support/captured.hpp"

namespace palpa::session {
namespace {

/// The number of early starts among `frames` that all arrive while another is in progress. With an early start, it
/// takes `early_s` to their drives; with waiting, `waiting_s`.
int started_early(EarlyStart& early_start, int frames, double waiting_s, double early_s) {
  int early = 0;
  for (int i = 0; i < frames; ++i) {
    const bool now = early_start.now();
    early += now ? 1 : 0;
    early_start.took(now ? early_s : waiting_s, now);
  }
  return early;
}

TEST(EarlyStart, WaitsWhereTheDeviceOnlySharesWhatItHas) {
  struct Case {
    const char* where;
    double hold_s, early_s;
    int most;
  };
  for (const Case& c : {Case{"both frames are late: only now and then it tries", 1.0, 0.110, 49},
                        {"nothing is gained, either", 1.0, 0.055, 49},
                        {"what is tried could be over before it sounds", 0.1, 0.110, 0}}) {
    EarlyStart early_start(c.hold_s);
    EXPECT_LE(started_early(early_start, 10'000, 0.055, c.early_s), c.most) << c.where;
    EXPECT_FALSE(early_start.now()) << c.where;
  }
}

TEST(EarlyStart, DoesNotWaitWhereTheDeviceOverlaps) {
  EarlyStart early_start(1.0);
  EXPECT_GT(started_early(early_start, 10'000, 0.020, 0.014), 9'000);
  // Another program takes part of the device, so it changes back.
  EXPECT_LT(started_early(early_start, 10'000, 0.020, 0.040), 1'000);
}

/// Two frames in progress on a device that processes one after the other.
struct SharedPlanner : test::FakePlanner {
  const test::SteppedClock* clock = nullptr;
  double takes_s = 0.02;
  struct Flight {
    SkinFrame frame;
    double done_s;
  };
  std::deque<Flight> flights;
  double free_from_s = 0;

  bool can_start() const override { return flights.size() < 2; }
  bool busy() const override { return !flights.empty(); }
  void start(const SkinFrame& frame) override {
    free_from_s = std::max(free_from_s, clock->now()) + takes_s;
    flights.push_back({frame, free_from_s});
  }
  bool step(Plan& plan, FrameReport& report) override {
    clock->sleep_until(flights.front().done_s);
    FakePlanner::start(flights.front().frame);
    flights.pop_front();
    return FakePlanner::step(plan, report);
  }
};

using test::SteppedLoop;

TEST(Overload, AFrameIsNotStartedWhereItsDrivesComeNoSooner) {
  for (const bool every_frame : {false, true}) {
    SteppedLoop<SharedPlanner> loop;
    loop.planner.clock = &loop.clock;
    loop.source.count = every_frame ? 60 : 400;
    loop.options.every_frame = every_frame;
    loop.run();
    // Two at a time on the device would take 40 ms each.
    EXPECT_LT(loop.stats.frame_to_plan_s.quantile(0.5), 0.035) << every_frame;
    EXPECT_LT(loop.stats.output.silent_drives * 3, loop.stats.output.drives) << every_frame;
  }
}

TEST(Overload, PlansThatWereReplacedAreCounted) {
  SteppedLoop<> loop;
  loop.source.count = 200;
  loop.setting.output.slot_s = 0.02;  // ten frames to a slot
  loop.run();
  EXPECT_GT(loop.stats.unplayed, 0u);
  const auto played = std::ranges::count_if(loop.link.plans, [](const auto& plan) { return plan.voices > 0; });
  EXPECT_EQ(static_cast<std::uint64_t>(played) + loop.stats.unplayed, loop.stats.planned);
}

/// The number of planned frames after which the warning comes if `every`th frame is planned; 0: none in 200.
int warned_after(std::uint64_t every, int touching_in_a_row = 1000) {
  SlowSolver solver;
  int after = 0, told = 0;
  for (int planned = 1; planned <= 200; ++planned) {
    if (planned % touching_in_a_row == 0) solver.idle();
    if (!solver.planned(1 + every * static_cast<std::uint64_t>(planned))) continue;
    after = planned;
    ++told;
  }
  EXPECT_LE(told, 1);
  return after;
}

TEST(Overload, ASlowSolverIsToldOnceIfItKeepsLeavingOutFrames) {
  EXPECT_EQ(warned_after(1), 0);
  EXPECT_EQ(warned_after(2), 7);
  EXPECT_EQ(warned_after(10), 2);
  EXPECT_EQ(warned_after(2, 5), 0);  // touches that end before it matters
}

TEST(Overload, OnlyTheSolverLoudestIsToldToBeSlowAndOnlyIfFramesMayBeLeftOut) {
  const auto told_of = [](array::Solver solver, bool every_frame) {
    SteppedLoop<> loop;
    loop.source.count = 100;
    loop.setting.output.hold_s = 2;  // a slow solver, but no overload
    loop.setting.output.drive.solver = solver;
    loop.options.every_frame = every_frame;
    loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(10e-3); };
    loop.source.before = [&](std::uint64_t frame) { loop.stop = frame + 1 == loop.source.count; };
    return test::stderr_of([&] { loop.run(); });
  };
  const std::string told = told_of(array::Solver::loudest, false);
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1) << told;
  EXPECT_TRUE(told.starts_with("palpa: warning: the solver loudest is slower than the frames come: a frame takes "))
      << told;
  EXPECT_CONTAINS(told, "take --solver gs-pat");
  EXPECT_EQ(told_of(array::Solver::loudest, true), "");
  EXPECT_EQ(told_of(array::Solver::gs_pat, false), "");
}

/// Records the requested effort, and is as slow as before.
struct SheddingPlanner : test::FakePlanner {
  std::vector<Effort> asked;
  void set_effort(const Effort& effort) override { asked.push_back(effort); }
  Effort most_shed() const override { return {2, 2}; }
};

TEST(Overload, IsToldOnceWithBothFiguresAfterWorkWasShedStepByStep) {
  SteppedLoop<SheddingPlanner> loop;
  loop.source.count = 400;
  loop.setting.output.hold_s = 0.020;
  loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(25e-3); };
  const std::string told = test::stderr_of([&] { loop.run(); });
  EXPECT_EQ(loop.planner.asked, (std::vector<Effort>{{1, 1}, {2, 1}, {2, 2}, {1, 1}}));
  ASSERT_TRUE(loop.stats.shed);
  EXPECT_EQ(loop.stats.shed->least, (Effort{2, 2}));
  EXPECT_GT(loop.stats.shed->frames, 0u);
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 2) << "what was shed, and that it was not enough: " << told;
  EXPECT_CONTAINS(told, "palpa: warning: overloaded: the time from frame to drives is ");
  EXPECT_CONTAINS(told, " ms, longer than the hold of 20 ms");
  EXPECT_CONTAINS(told, "give --hold ");
  EXPECT_CONTAINS(to_json(loop.stats), R"("shed":{"pixel_stride":2,"foci_part":2,"hold_s":0.02,"frames":)");
}

TEST(Overload, AnAdvisedHoldIsLongEnoughForFramesThatTakeHalfAsLongAgain) {
  const auto told_of = [](double hold_s, double takes_s) {
    SteppedLoop<> loop;
    loop.source.count = 30;
    loop.options.every_frame = true;  // no frame waits for another
    loop.setting.output.hold_s = hold_s;
    loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(takes_s); };
    return test::stderr_of([&] { loop.run(); });
  };
  for (const double takes_s : {0.020, 0.095, 0.400, 3.2}) {
    const std::string told = told_of(takes_s / 2, takes_s);
    std::smatch advised;
    ASSERT_TRUE(std::regex_search(told, advised, std::regex(R"(give --hold (\d+)ms, or )"))) << told;
    const double hold_s = std::stod(advised[1]) / 1e3;
    EXPECT_EQ(told_of(hold_s, 1.5 * takes_s), "") << takes_s;
    EXPECT_LE(hold_s, 10);
  }
  EXPECT_CONTAINS(told_of(1, 3.5), "before it sounds; give smaller frames") << "--hold is at most 10 s";
}

TEST(Overload, NothingIsShedWhereEveryFrameIsLookedAt) {
  SteppedLoop<SheddingPlanner> loop;
  loop.source.count = 20;
  loop.options.every_frame = true;
  loop.setting.output.hold_s = 0.005;
  loop.planner.before = [&](std::uint64_t) { loop.clock.sleep(8e-3); };
  test::stderr_of([&] { loop.run(); });
  for (const Effort& effort : loop.planner.asked)
    EXPECT_TRUE(effort.whole());
  EXPECT_FALSE(loop.stats.shed);
}

}  // namespace
}  // namespace palpa::session
