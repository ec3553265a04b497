// The data that the output thread sends, and when.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "array/drive.hpp"
#include "base/system/real_time.hpp"
#include "fakes.hpp"
#include "session/loop/output.hpp"
#include "session/previews/ear_sound.hpp"
#include "stepped_clock.hpp"
#include "support/instrumented.hpp"
#include "support/locked_memory.hpp"
#include "support/watched_heap.hpp"

namespace palpa::session {
namespace {

struct Output {
  array::Layout layout = test::small_layout();
  OutputSetting setting{layout, {}, 1.5e-3, 0.1};

  Plan plan_of(array::Schedule schedule, double captured_s = 0) {
    Plan plan;
    plan.schedule = std::move(schedule);
    plan.captured_s = captured_s;
    test::list_drives(layout, plan);
    return plan;
  }
  array::Drive slot(const Plan& plan, std::uint64_t number, double now_s) {
    SlotScratch scratch;
    const auto drive = drive_of_slot(plan, number, now_s, setting, scratch);
    return {drive.begin(), drive.end()};
  }
};

bool same(const array::Drive& a, const array::Drive& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].amplitude != b[i].amplitude || a[i].phase != b[i].phase) return false;
  }
  return a.size() == b.size();
}

TEST(Output, NothingSoundsAfterTheHoldHoweverLateItsPlanCame) {
  Output out;
  Plan plan = out.plan_of(test::touching(Vec3(0, 0.15, 0)), 5.0);
  for (const double more_s : {0.0, 0.05, 0.1}) {
    plan.more_hold_s = more_s;
    for (const double age_s : {0.0, 0.005, 0.06, 0.099, 0.101, 0.14, 0.149, 0.151, 0.199, 0.201, 3600.0})
      EXPECT_EQ(test::loudest_of(out.slot(plan, 0, 5.0 + age_s)), age_s < 0.1 + more_s ? 1.0f : 0.0f) << age_s;
  }
  plan.more_hold_s = 0;
  EXPECT_EQ(test::loudest_of(out.slot(plan, 0, 5.1)), 0.0f) << "not in its last instant either";
}

TEST(Output, APlanWithoutATimeOrATouchIsSilence) {
  Output out;
  for (const Plan& plan :
       {out.plan_of(test::touching(Vec3(0, 0.15, 0)), std::nan("")), out.plan_of(array::Schedule())}) {
    for (const double now_s : {0.0, 5.0, 1e9}) {
      const array::Drive drive = out.slot(plan, 3, now_s);
      EXPECT_EQ(drive.size(), out.layout.transducers.size());
      EXPECT_EQ(test::loudest_of(drive), 0.0f) << now_s;
    }
  }
  EXPECT_EQ(out.plan_of(array::Schedule()).cycle.plays, Plays::nothing);
}

/// The audible preview: only boards whose own clock modulates change a focus that stands still between slots.
TEST(EarDrives, OfAModulatedFocusFollowTheBoardsClock) {
  array::Schedule schedule = test::touching(Vec3(0, 0.15, 0), 200);
  schedule.voices[0].foci.resize(1);
  schedule.voices[0].order = {0};
  for (const auto& [layout, modulated_s] : {std::pair(test::small_layout(), 1.5e-3),
                                            {array::load_layout("openmpd"), 1.5e-3},
                                            {array::load_layout("autd3"), 0.25e-3}}) {
    for (const bool modulates : {true, false}) {
      schedule.voices[0].modulation_hz = modulates ? 200 : 0;
      Plan plan{.schedule = schedule};
      test::list_drives(layout, plan);
      SessionSetting setting;
      setting.layout = layout;
      const EarDrives drives = ear_drives(plan, setting, false);
      EXPECT_EQ(drives.slot_s, modulates ? modulated_s : 1.5e-3) << layout.name;
      ASSERT_FALSE(drives.drives.empty());
      // A whole period of 5 ms, unless one drive is all.
      const std::size_t slots = drives.drives.size() / drives.transducers;
      EXPECT_EQ(slots, !modulates ? 1U : modulated_s < 1e-3 ? 20U : 10U) << layout.name;
    }
  }
}

TEST(Output, ASharedModulationIsOneScalarOverTheWholeDrive) {
  Output out;
  const Plan plain = out.plan_of(test::touching(Vec3(0, 0.15, 0)));
  const Plan modulated = out.plan_of(test::touching(Vec3(0, 0.15, 0), 200));
  EXPECT_EQ(modulated.cycle.modulation_hz, 200.0);
  for (std::uint64_t slot = 0; slot < 20; ++slot) {
    const auto a = out.slot(plain, slot, 0), b = out.slot(modulated, slot, 0);
    const double pressure = (1 + std::sin(2 * M_PI * 200 * (static_cast<double>(slot) + 0.5) * 1.5e-3)) / 2;
    const double expected = std::sqrt(pressure);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(b[i].amplitude, a[i].amplitude * expected, 1e-6);
      EXPECT_EQ(b[i].phase, a[i].phase);
    }
  }
}

TEST(Output, FingersThatDifferInModulationAreSummedPerSlotWhetherListedOrNot) {
  Output out;
  for (const double modulation_hz : {200.0, 199.37}) {
    array::Schedule schedule = test::touching(Vec3(0, 0.15, 0));
    schedule.add_voice() = test::touching(Vec3(0.06, 0.15, 0.02), modulation_hz).voices[0];
    const Plan plan = out.plan_of(schedule);
    EXPECT_EQ(plan.cycle.modulation_hz, 0.0);
    const bool repeats = modulation_hz == 200;  // after ten slots of 1.5 ms
    EXPECT_EQ(plan.cycle.plays, repeats ? Plays::pattern : Plays::slot_by_slot);
    if (repeats) {
      EXPECT_EQ(plan.cycle.length, 10u);
    }
    for (const std::uint64_t slot : repeats ? std::vector{0ull, 4ull, 13ull} : std::vector{777ull}) {
      std::vector<array::SlotFocus> foci;
      array::foci_of_slot(schedule, slot, foci);
      array::Drive expected(out.layout.transducers.size());
      array::drive_for(out.layout, foci, {}, expected);
      EXPECT_TRUE(same(out.slot(plan, slot, 0), expected)) << slot;
    }
  }
}

TEST(Output, APlanHasTheFociOfDrivesOfOneFocusEach) {
  Output out;
  array::Schedule schedule = test::touching(Vec3(0, 0.15, 0));
  const Plan one = out.plan_of(schedule);
  ASSERT_EQ(one.foci.size(), 10u);
  for (std::size_t slot = 0; slot < 10; ++slot)
    EXPECT_EQ(one.foci[slot], schedule.voices[0].foci[schedule.voices[0].order[slot]]);
  schedule.voices[0].foci_per_slot = 2;
  EXPECT_TRUE(out.plan_of(schedule).foci.empty());
  schedule.voices[0].foci_per_slot = 1;
  schedule.add_voice() = test::touching(Vec3(0.06, 0.15, 0)).voices[0];
  EXPECT_TRUE(out.plan_of(schedule).foci.empty());
}

TEST(Output, AReservedScratchNeverGrows) {
  Output out;
  for (const bool pressures : {false, true}) {
    for (const array::Solver solver : {array::Solver::naive, array::Solver::gs_pat, array::Solver::loudest}) {
      if (pressures && solver == array::Solver::loudest) continue;
      out.setting.drive.solver = solver;
      out.setting.drive.constraint = pressures ? array::DriveOptions().constraint : array::Constraint::uniform;
      array::Schedule schedule;
      for (unsigned f = 0; f < (pressures ? 7 : 2); ++f) {
        array::Voice& voice = schedule.add_voice();
        voice = test::touching(Vec3(0.03 * f, 0.15, 0), f == 1 ? 199.37 : 0).voices[0];
        if (!pressures) continue;
        voice.foci_per_slot = static_cast<std::uint32_t>(voice.foci.size());
        voice.pressure_pa = voice.target_pa = 10;
        voice.reached_pa = 10;
      }
      const Plan plan = out.plan_of(schedule);
      ASSERT_FALSE(plan.cycle.is_listed());
      SlotScratch scratch;
      scratch.reserve(out.setting);
      for (const std::uint64_t slot : {0ull, 1ull, 777ull}) {
        const auto play_slot = [&] { drive_of_slot(plan, slot, 0, out.setting, scratch); };
        EXPECT_EQ(test::allocations_of(play_slot), 0u) << slot;
      }
      EXPECT_EQ(scratch.foci.size(), pressures ? 70u : 2u) << "the slots were not computed";
    }
  }
}

/// A plan of one finger that was captured at 0 s, and its output.
struct Playing : Output {
  test::SteppedClock clock;
  Newest<Plan> plans;
  const Plan* plan = nullptr;
  OutputStats stats;

  Playing() {
    plans.back() = plan_of(test::touching(Vec3(0, 0.15, 0)), 0.0);
    plan = &plans.back();
    plans.publish();
  }
  /// Asks for the end with the first drive from `time_s` on.
  void play_until(double time_s, Link& link) {
    std::atomic<bool> stop{false};
    test::Watcher watcher;
    watcher.on_sent = [&](bool, const HandOver&) {
      if (clock.now() >= time_s) stop = true;
    };
    play(link, plans, setting, clock, Ending{stop}, stats, watcher);
  }
};

TEST(Output, SendsSilenceLastWhenStopped) {
  Playing out;
  test::SpyLink link;
  out.play_until(0.06, link);
  EXPECT_EQ(link.slots.size(), 42u) << "of slots 0 to 40, and the silence";
  EXPECT_GT(*std::max_element(link.loudest.begin(), link.loudest.end()), 0.9f);
  EXPECT_TRUE(link.ended_silent());
  EXPECT_EQ(link.plans.back().voices, 0u);
  EXPECT_TRUE(link.finished);
  EXPECT_TRUE(std::is_sorted(link.slots.begin(), link.slots.end()));
  EXPECT_EQ(std::adjacent_find(link.slots.begin(), link.slots.end()), link.slots.end()) << "a slot was sent twice";
}

TEST(Output, KeepsTheProcessInMemoryForALinkThatPlaysInRealTime) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: sanitizers lock no memory";
  if (!KeptInMemory().holds()) GTEST_SKIP() << "skipped: this machine allows no locked memory (ulimit -l)";
  struct Into : test::SpyLink {
    bool player = false;
    bool plays() const override { return player; }
  };
  for (const bool real : {false, true}) {
    for (const bool plays : {false, true}) {
      Playing out;
      Into link;
      link.player = plays;
      std::atomic<bool> stop{false};
      test::Watcher watcher;
      long kib = -1;
      watcher.on_sent = [&](bool, const HandOver&) {
        kib = test::locked_kib();
        stop = true;
      };
      play(link, out.plans, out.setting, real ? real_clock() : out.clock, Ending{stop}, out.stats, watcher);
      EXPECT_EQ(kib > 0, real && plays) << kib;
      EXPECT_EQ(test::locked_kib(), 0) << "afterwards";
    }
  }
}

TEST(Output, TellsAPlanOnceAndFromWhenUntilWhen) {
  Playing out;
  out.setting.hold_s = 0.03;
  test::SpyLink link;
  const std::vector<const void*> there{&out.plan->schedule, out.plan->drives.data()};
  out.play_until(0.08, link);
  ASSERT_EQ(link.plans.size(), 3u) << "the plan, that it expired, the end";
  const test::SpyLink::Played& played = link.plans[0];
  EXPECT_EQ(played.voices, 1u);
  EXPECT_EQ((std::vector<const void*>{played.schedule, played.drives}), there) << "it was copied";
  EXPECT_EQ(played.slots.cycle.length, 10u);
  EXPECT_EQ(played.slots.from, 0u);
  EXPECT_EQ(played.slots.until, 20u) << "30 ms are 20 slots";
  EXPECT_EQ(link.plans[1].voices, 0u);
  EXPECT_EQ(link.plans[1].slots.from, 20u);
  EXPECT_EQ(link.plans[2].voices, 0u);
}

TEST(Output, LeavesOutSlotsThatItOversleptInsteadOfSendingThemLate) {
  struct DawdlingLink : test::SpyLink {
    const test::SteppedClock& clock;
    explicit DawdlingLink(const test::SteppedClock& by) : clock(by) {}
    void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
      if (slots.size() == 10) clock.sleep(0.06);
      SpyLink::send(slot, drive);
    }
  };
  Playing out;
  out.setting.hold_s = 10;
  DawdlingLink link(out.clock);
  out.play_until(0.15, link);
  ASSERT_GT(link.slots.size(), 12u);
  EXPECT_EQ(link.slots[11] - link.slots[10], 40u) << "60 ms are 40 slots";
  EXPECT_EQ(out.stats.skipped_slots, 39u);
}

}  // namespace
}  // namespace palpa::session
