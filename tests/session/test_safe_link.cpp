// What reaches a link through the safety layer.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "base/log.hpp"
#include "fakes.hpp"
#include "session/links/safe_link.hpp"
#include "session/plan/plan.hpp"
#include "support/boards.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

constexpr double slot_s = 1.5e-3;

struct Player {
  test::SpyLink spy;
  array::Drive loud{{1.0f, 0.5f}, {0.5f, -3.0f}, {0.0f, 3.0f}}, silent{3, {0.0f, 0.0f}};
  Plan touch;
  Plan nothing;

  Player() {
    touch.schedule = test::touching(Vec3(0, 0.15, 0));
    touch.schedule.time_s = 7;
    touch.cycle = {Plays::pattern, 2};
    touch.drives = loud;
    touch.drives.insert(touch.drives.end(), loud.begin(), loud.end());
  }
  static PlayedPlan at(const Plan& plan, std::uint64_t slot) { return played(plan, 3, slot, slot + 60); }
  void send_loud(SafeLink& safe, std::uint64_t from, std::uint64_t until) const {
    for (std::uint64_t slot = from; slot < until; ++slot)
      safe.send(slot, loud);
  }
};

TEST(SafeLink, PassesEverythingOnAsItIsAndCopiesNothing) {
  Player p;
  SafeLink safe(p.spy, 3);
  safe.plan(p.at(p.touch, 4));
  safe.send(4, p.loud);
  safe.send(9, p.silent);
  ASSERT_EQ(p.spy.plans.size(), 1u);
  EXPECT_EQ(p.spy.plans[0].schedule, &p.touch.schedule);
  EXPECT_EQ(p.spy.plans[0].drives, p.touch.drives.data());
  EXPECT_EQ(p.spy.plans[0].slots.from, 4u);
  EXPECT_EQ(p.spy.plans[0].slots.until, 64u);
  EXPECT_EQ(p.spy.plans[0].slots.cycle.length, 2u);
  EXPECT_EQ(p.spy.sent, (std::vector<const void*>{p.loud.data(), p.silent.data()}));
  EXPECT_EQ(p.spy.slots, (std::vector<std::uint64_t>{4, 9}));
  EXPECT_FALSE(safe.must_fade());
}

/// A link that an OpenMPD board plays, and the drives that it got.
struct BoardSpy : Link {
  array::Layout layout = array::load_layout("openmpd");
  array::Drive planned;
  std::vector<array::Drive> drives;
  void plan(const PlayedPlan& plan) override { planned.assign(plan.drives.begin(), plan.drives.end()); }
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override {
    drives.emplace_back(drive.begin(), drive.end());
  }
  bool plays_plans() const override { return plays; }
  const array::Layout* boards() const override { return &layout; }
  bool plays = true;  ///< plans
};

/// A plan of one drive with all transducers at this amplitude.
Plan plan_of(const array::Layout& layout, float amplitude, std::optional<double> pressure_pa = {}) {
  Plan plan;
  plan.schedule = test::touching(Vec3(0, 0.15, 0));
  plan.schedule.voices[0].pressure_pa = pressure_pa;
  plan.cycle = {Plays::pattern, 1};
  plan.drives.assign(layout.transducers.size(), {amplitude, 0.0f});
  return plan;
}

TEST(SafeLink, ABoardGetsTheAmplitudesThatItHasAndOnlyWhatSoundsIsCounted) {
  const float least = std::sin(std::numbers::pi_v<float> / 128);
  for (const double ramp_s : {0.0, slot_s}) {
    log::Tail log;
    std::vector<bool> sounded;
    BoardSpy spy;
    std::atomic<double> ceiling{0.03};
    SafeLink safe(spy, 256, {.ramp_s = ramp_s, .ceiling_now = &ceiling}, slot_s,
                  [&](bool sounds, const HandOver&) { sounded.push_back(sounds); });
    const Plan plan = plan_of(spy.layout, 1);
    const auto play = [&](double now, std::uint64_t slot) {
      ceiling = now;
      safe.plan(played(plan, 256, slot, slot + 60));
      safe.send_planned(slot, plan.drives);
    };
    play(0.03, 0);
    EXPECT_EQ(spy.planned[9].amplitude, least);
    EXPECT_EQ(spy.drives.back()[9].amplitude, least);
    EXPECT_TRUE(log.take().empty());
    play(0.02, 1);
    EXPECT_EQ(spy.planned[9].amplitude, 0);
    EXPECT_EQ(spy.drives.back()[9].amplitude, 0);
    const std::vector<log::Line> lines = log.take();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_CONTAINS(
        lines[0].text,
        "the array is silent: the loudest amplitude is 0.02, and the least that OpenMPD boards play is 0.0246");
    play(0.02, 2);
    play(0, 3);
    EXPECT_TRUE(log.take().empty()) << "once, and not of a ceiling of zero";
    play(0.3, 4);
    play(0.01, 5);
    EXPECT_EQ(log.take().size(), 1u);
    EXPECT_EQ(sounded, (std::vector<bool>{true, false, false, false, true, false}));
    EXPECT_EQ(safe.handed_over().loop.drives, 2u);
  }
}

/// A sensation whose peaks alone reach the least step: one drive of ten sounds.
TEST(SafeLink, ThatMostOfASoundIsBelowTheStepsIsSaidOnce) {
  for (const int sounding_of_ten : {1, 6}) {
    log::Tail log;
    BoardSpy spy;
    SafeLink safe(spy, 256, {.ceiling = 0.03}, slot_s);
    Plan plan = plan_of(spy.layout, 1);
    plan.schedule.once = true;
    plan.cycle = {Plays::slot_by_slot};
    plan.drives.clear();
    safe.plan(played(plan, 256, 0, 3000));
    std::uint64_t slot = 0;
    const auto send = [&](std::uint64_t drives) {
      for (std::uint64_t end = slot + drives; slot < end; ++slot) {
        const bool peak = slot % 10 < static_cast<std::uint64_t>(sounding_of_ten);
        safe.send_planned(slot, array::Drive(256, {peak ? 1.0f : 0.5f, 0}));
        safe.send_planned(slot, array::Drive(256, {0, 0}));  // pauses of the sensation do not count
      }
    };
    send(600);
    EXPECT_TRUE(log.take().empty()) << "too early to judge";
    send(600);
    const std::vector<log::Line> lines = log.take();
    EXPECT_EQ(lines.size(), sounding_of_ten == 1 ? 1u : 0u);
    if (lines.size() == 1) {
      EXPECT_CONTAINS(lines[0].text, "most of the sound is too faint: 600 of 667 drives have no amplitude of 0.0246");
    }
    send(600);
    safe.finish();
    EXPECT_TRUE(log.take().empty()) << "once";
  }
}

/// A short one is judged at its end.
TEST(SafeLink, AShortFaintSoundIsSaidAtItsEnd) {
  log::Tail log;
  BoardSpy spy;
  SafeLink safe(spy, 256, {.ceiling = 0.02}, slot_s);
  for (std::uint64_t slot = 0; slot < 30; ++slot)
    safe.send(slot, array::Drive(256, {1, 0}));
  EXPECT_TRUE(log.take().empty());
  safe.finish();
  EXPECT_EQ(log.take().size(), 1u);
}

TEST(SafeLink, ACeilingLowersThePressuresThatAPlanSays) {
  struct Told : Link {
    std::optional<double> reached_pa;
    double target_pa = 0;
    void plan(const PlayedPlan& plan) override {
      if (plan.schedule.voice_count == 0) return;
      reached_pa = plan.schedule.voices[0].reached_pa;
      target_pa = plan.schedule.voices[0].target_pa;
    }
    void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
  };
  Player p;
  p.touch.schedule.voices[0].pressure_pa = p.touch.schedule.voices[0].target_pa = 500;
  p.touch.schedule.voices[0].reached_pa = 480;
  Told told;
  SafeLink safe(told, 3, {.ceiling = 0.3});
  safe.plan(p.at(p.touch, 0));
  EXPECT_NEAR(told.reached_pa.value_or(0), 144, 1e-9);
  EXPECT_NEAR(told.target_pa, 150, 1e-9);
}

/// A plan of one drive for a focus, as loud as this part of the most.
Plan focus_of(const array::Layout& layout, double pressure_pa) {
  const array::SlotFocus focus{.position = Vec3(0, 0, 0.15)};
  Plan plan = plan_of(layout, 1, pressure_pa);
  array::Voice& voice = plan.schedule.voices[0];
  voice.foci = {focus.position};
  voice.order = {0};
  plan.drives = array::drive_for(layout, {&focus, 1});
  const double full_pa = std::abs(acoustics::pressure_at(layout, plan.drives, focus.position));
  for (array::TransducerDrive& one : plan.drives)
    one.amplitude *= static_cast<float>(std::min(1.0, pressure_pa / full_pa));
  return plan;
}

TEST(SafeLink, ARequestedPressureIsPlayedByACommonFactorAtAnyCeilingAndOnARamp) {
  for (const double ceiling : {1.0, 0.5, 0.3}) {
    BoardSpy spy;
    spy.plays = false;
    SafeLink safe(spy, 256, {.ceiling = ceiling, .ramp_s = 8 * slot_s}, slot_s);
    const Plan plan = focus_of(spy.layout, 1200);
    safe.plan(played(plan, 256, 0, 60));
    for (std::uint64_t slot = 0; slot < 10; ++slot)
      safe.send_planned(slot, plan.drives);
    safe.plan(played(Plan(), 256, 10, 10));
    for (std::uint64_t slot = 10; slot < 20; ++slot)
      safe.send(slot, array::Drive(256, {0, 0}));
    for (std::size_t slot = 0; slot < spy.drives.size(); ++slot) {
      const double part = slot < 8 ? (slot + 1) / 8.0 : slot < 10 ? 1 : slot < 18 ? (17 - slot) / 8.0 : 0;
      const double asked = 1200 * ceiling * part;
      const double now = std::abs(acoustics::pressure_at(spy.layout, spy.drives[slot], Vec3(0, 0, 0.15)));
      EXPECT_LE(now, asked * (1 + 1e-3) + 1e-6) << slot;
      EXPECT_GE(now, asked > 150 ? 0.95 * asked : 0) << slot;
    }
  }
}

TEST(SafeLink, ADriveOfABoardThatPlaysPlansIsThePlans) {
  BoardSpy spy;
  spy.layout = array::load_layout(test::on_off_board());
  SafeLink safe(spy, 256, {.ceiling = 0.004}, slot_s);
  Plan plan = plan_of(spy.layout, 1);
  plan.cycle.modulation_hz = 200;
  safe.plan(played(plan, 256, 0, 60));
  const auto on = [](const array::Drive& drive) {
    return std::ranges::count(drive, 1.0f, &array::TransducerDrive::amplitude);
  };
  EXPECT_EQ(on(spy.planned), 1);
  array::Drive drive = plan.drives;
  for (std::uint64_t slot = 0; slot < 6; ++slot) {
    for (array::TransducerDrive& one : drive)
      one.amplitude = slot < 5 ? 0.3f : 0.0f;  // the modulation of this slot: the board has its own
    safe.send_planned(slot, drive);
    EXPECT_EQ(on(spy.drives.back()), slot < 5 ? 1 : 0);
  }
  EXPECT_EQ(safe.handed_over().loop.drives, 5u);
}

TEST(SafeLink, ABoardThatPlaysNoPlansGetsNoDrivesOfThemButIsWarnedOf) {
  log::Tail log;
  BoardSpy spy;
  spy.plays = false;
  SafeLink safe(spy, 256, {.ceiling = 0.02}, slot_s);
  const Plan plan = plan_of(spy.layout, 1);
  safe.plan(played(plan, 256, 0, 60));
  EXPECT_TRUE(spy.planned.empty());
  EXPECT_EQ(log.take().size(), 1u);
}

TEST(SafeLink, TheFactorsOfABoardsFileCount) {
  log::Tail log;
  BoardSpy spy;
  spy.layout.factors.assign(256, 0.5f);
  SafeLink safe(spy, 256, {.ceiling = 0.04}, slot_s);
  const Plan plan = plan_of(spy.layout, 1);
  safe.plan(played(plan, 256, 0, 60));
  safe.send_planned(0, plan.drives);
  EXPECT_EQ(safe.handed_over().loop.drives, 0u);
  const std::vector<log::Line> lines = log.take();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_CONTAINS(lines[0].text, "the least that OpenMPD boards play with the factors of their files is 0.0491");
}

TEST(SafeLink, AllButACeilingOfZeroLeavesAPlannedDrivePlanned) {
  struct Told : Link {
    std::vector<bool> planned;
    void plan(const PlayedPlan&) override {}
    void send(std::uint64_t, std::span<const array::TransducerDrive>) override { planned.push_back(false); }
    void send_planned(std::uint64_t, std::span<const array::TransducerDrive>) override { planned.push_back(true); }
  };
  const Player p;
  std::atomic<double> gain{0.5};
  for (const bool plain : {true, false}) {
    Told told;
    gain = 0.5;
    SafeLink safe(told, 3, plain ? Safety() : Safety{.gain_now = &gain});
    safe.plan(p.at(p.touch, 0));
    safe.send_planned(0, p.loud);
    safe.send_planned(1, p.silent);
    safe.send(2, p.silent);
    gain = 0;
    safe.send_planned(3, p.loud);
    safe.finish();
    EXPECT_EQ(told.planned, (std::vector<bool>{true, true, false, plain, false})) << plain;
  }
}

TEST(SafeLink, SilenceIsTheLastThingThatALinkGets) {
  Player p;
  SafeLink safe(p.spy, 3);
  safe.plan(p.at(p.touch, 0));
  safe.send(6, p.loud);
  safe.finish();
  EXPECT_TRUE(p.spy.ended_silent());
  EXPECT_EQ(p.spy.slots.back(), 7u);
  EXPECT_EQ(p.spy.plans.back().voices, 0u);
  EXPECT_TRUE(p.spy.finished);
  const std::size_t sent = p.spy.slots.size(), plans = p.spy.plans.size();
  safe.send(8, p.loud);
  safe.plan(p.at(p.touch, 8));
  safe.silence();
  safe.finish();
  EXPECT_EQ(p.spy.slots.size(), sent) << "something came after the silence";
  EXPECT_EQ(p.spy.plans.size(), plans);
}

TEST(SafeLink, ReportsEachDriveThatTheLinkTookTheLastSilenceToo) {
  Player p;
  std::vector<bool> sounding;
  const auto sent = [&](bool sounds, const HandOver&) { sounding.push_back(sounds); };
  SafeLink safe(p.spy, 3, {.ceiling = 0.5}, slot_s, sent);
  safe.send(0, p.loud);
  safe.send(1, p.silent);
  safe.send(2, p.loud);
  safe.finish();
  EXPECT_EQ(sounding, (std::vector<bool>{true, false, true, false}));
  EXPECT_EQ(p.spy.loudest, (std::vector<float>{0.5f, 0.0f, 0.5f, 0.0f}));
}

TEST(SafeLink, SilenceComesWhenItsCallerThrows) {
  for (const bool planned_for_later : {false, true}) {
    Player p;
    const auto player = [&] {
      SafeLink safe(p.spy, 3, {.ceiling = 0.5, .ramp_s = 15e-3});
      safe.plan(p.at(p.touch, 0));
      p.send_loud(safe, 0, 20);
      if (planned_for_later) safe.plan(p.at(p.touch, 100));
      throw failure("the caller broke");
    };
    EXPECT_STREQ(palpa::test::thrown_by(player).what(), "the caller broke");
    EXPECT_TRUE(p.spy.ended_silent());
    EXPECT_EQ(p.spy.plans.back().voices, 0u);
    EXPECT_TRUE(p.spy.finished);
    EXPECT_GE(p.spy.slots.back(), planned_for_later ? 100u : 20u) << "a board that goes by slots would sound on";
  }
}

TEST(SafeLink, SilenceComesWhenTheLinkThrows) {
  for (const bool broken : {false, true}) {
    Player p;
    p.spy.fail_at = 2;
    p.spy.broken = broken;
    const auto player = [&] {
      SafeLink safe(p.spy, 3);
      p.send_loud(safe, 0, 20);
    };
    EXPECT_STREQ(palpa::test::thrown_by(player).what(), "spy: the link broke");
    EXPECT_TRUE(p.spy.ended_silent()) << "broken " << broken;
    EXPECT_EQ(p.spy.slots.back(), 2u) << "silence takes the place of the drive that failed";
    EXPECT_TRUE(p.spy.finished);
  }
}

TEST(SafeLink, SilenceComesInASlotOfItsOwnWhenTheObserverThrows) {
  Player p;
  const auto player = [&] {
    SafeLink safe(p.spy, 3, {}, 1e-3, [](bool audible, const HandOver&) {
      if (audible) throw failure("the observer broke");
    });
    safe.send(7, p.loud);
  };
  EXPECT_STREQ(palpa::test::thrown_by(player).what(), "the observer broke");
  EXPECT_TRUE(p.spy.ended_silent());
  EXPECT_EQ(p.spy.slots, (std::vector<std::uint64_t>{7, 8}));
}

TEST(SafeLink, AllThreePartsOfTheEndAreTriedAndTheFirstErrorIsThrown) {
  struct Broken : test::SpyLink {
    void plan(const PlayedPlan&) override { throw failure("plan"); }
    void finish() override {
      finished = true;
      throw failure("finish");
    }
  } link;
  SafeLink safe(link, 3);
  EXPECT_STREQ(palpa::test::thrown_by([&] { safe.finish(); }).what(), "plan");
  EXPECT_TRUE(link.ended_silent());
  EXPECT_TRUE(link.finished);
}

TEST(SafeLink, TheCeilingMayChangeWhileItPlays) {
  for (const double ramp_s : {0.0, 10 * slot_s}) {
    Player p;
    std::atomic<double> ceiling{1.0};
    SafeLink safe(p.spy, 3, {.ceiling = 0.1, .ramp_s = ramp_s, .ceiling_now = &ceiling});
    safe.plan(p.at(p.touch, 0));
    std::uint64_t slot = 0;
    const auto plays = [&](double value) {
      ceiling = value;
      safe.plan(p.at(p.touch, slot));
      for (int i = 0; i < 15; ++i)
        safe.send(slot++, p.loud);
      return p.spy.loudest.back();
    };
    EXPECT_EQ(plays(1), 1.0f) << "not the one of the beginning";
    EXPECT_EQ(p.spy.plans.back().gain, 1.0);
    EXPECT_EQ(plays(0.25), 0.25f);
    EXPECT_EQ(p.spy.plans.back().gain, 0.25);
    EXPECT_EQ(p.spy.plans.back().loudest, 0.25f);
    EXPECT_EQ(plays(0.5), 0.5f);
    EXPECT_EQ(plays(7), 1.0f);
    EXPECT_EQ(plays(-7), 0.0f);
    EXPECT_EQ(plays(std::numeric_limits<double>::quiet_NaN()), 0.0f);
    safe.finish();
    EXPECT_TRUE(p.spy.ended_silent());
  }
}

TEST(SafeLink, AGainMultipliesTheCeilingAndNeverRaisesIt) {
  for (const bool changing : {false, true}) {
    Player p;
    std::atomic<double> ceiling{0.5}, gain{1.0};
    SafeLink safe(p.spy, 3, {.ceiling = 0.5, .ceiling_now = changing ? &ceiling : nullptr, .gain_now = &gain});
    std::uint64_t slot = 0;
    const auto plays = [&](double value) {
      gain = value;
      safe.plan(p.at(p.touch, slot));
      safe.send(slot++, p.loud);
      return p.spy.loudest.back();
    };
    EXPECT_EQ(plays(1), 0.5f);
    EXPECT_EQ(p.spy.plans.back().gain, 0.5);
    EXPECT_EQ(plays(0.5), 0.25f);
    EXPECT_EQ(p.spy.plans.back().gain, 0.25);
    EXPECT_EQ(p.spy.plans.back().loudest, 0.25f);
    EXPECT_EQ(p.spy.plans.back().slots.until, 61u);
    EXPECT_EQ(p.touch.schedule.voices[0].gain, 1.0) << "what is played is not changed";
    EXPECT_EQ(p.touch.drives[0].amplitude, 1.0f);
    EXPECT_EQ(plays(0), 0.0f);
    EXPECT_EQ(plays(7), 0.5f);
    EXPECT_EQ(plays(-1), 0.0f);
    EXPECT_EQ(plays(std::numeric_limits<double>::quiet_NaN()), 0.0f);
    if (changing) {
      ceiling = 0.25;
      EXPECT_EQ(plays(0.5), 0.125f);
    }
    safe.plan(p.at(p.nothing, slot));
    EXPECT_EQ(p.spy.plans.back().voices, 0u);
    EXPECT_FALSE(safe.must_fade()) << "there is no ramp";
    safe.finish();
  }
}

TEST(SafeLink, GoesUpTheRampAndDownAgainAndThenIsSilent) {
  Player p;
  SafeLink safe(p.spy, 3, {.ceiling = 0.5, .ramp_s = 10 * slot_s});
  safe.plan(p.at(p.touch, 0));
  for (std::uint64_t slot = 0; slot < 15; ++slot) {
    safe.send(slot, p.loud);
    EXPECT_NEAR(p.spy.loudest.back(), 0.5 * std::min(0.1 * (static_cast<double>(slot) + 1), 1.0), 1e-6) << slot;
  }
  EXPECT_EQ(p.spy.plans.back().gain, 0.5);
  EXPECT_EQ(p.spy.plans.back().slots.until, 60u);
  EXPECT_TRUE(safe.must_fade());

  safe.plan(p.at(p.nothing, 15));
  EXPECT_EQ(p.spy.plans.back().voices, 1u) << "it is not silent yet";
  for (std::uint64_t slot = 15; slot < 30; ++slot) {
    safe.send(slot, p.silent);
    const double level = std::max(1 - 0.1 * (static_cast<double>(slot) - 14), 0.0);
    EXPECT_NEAR(p.spy.loudest.back(), 0.5 * level, 1e-6) << slot;
    EXPECT_EQ(safe.must_fade(), slot < 24) << slot;
    EXPECT_EQ(p.spy.plans.back().voices, slot < 24 ? 1u : 0u) << slot;
  }
  EXPECT_TRUE(p.spy.ended_silent());
  EXPECT_EQ(p.spy.plans.back().slots.from, 24u);
  safe.finish();
  EXPECT_TRUE(p.spy.ended_silent());
}

TEST(SafeLink, GivesAPlanAgainWhileTheRampMoves) {
  Player p;
  SafeLink safe(p.spy, 3, {.ramp_s = 30 * slot_s});
  safe.plan(p.at(p.touch, 0));
  p.send_loud(safe, 0, 50);
  // Every seventh slot is the first one 10 ms later; the last plan comes when the ramp is at its top.
  ASSERT_EQ(p.spy.plans.size(), 6u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(p.spy.plans[i].slots.from, 7 * i);
    EXPECT_NEAR(p.spy.plans[i].gain, (static_cast<double>(7 * i) + 1) / 30, 1e-9);
    EXPECT_NEAR(p.spy.plans[i].loudest, p.spy.plans[i].gain, 1e-6);
  }
  EXPECT_EQ(p.spy.plans[5].slots.from, 29u);
  EXPECT_EQ(p.spy.plans[5].gain, 1.0);
  // On the way down, it reports when it is silent.
  safe.plan(p.at(p.nothing, 50));
  safe.send(50, p.silent);
  EXPECT_EQ(p.spy.plans.back().slots.from, 50u);
  EXPECT_EQ(p.spy.plans.back().slots.until, 79u);
}

TEST(SafeLink, SoundThatComesBackGoesUpFromWhereItIs) {
  Player p;
  SafeLink safe(p.spy, 3, {.ramp_s = 4 * slot_s});
  safe.plan(p.at(p.touch, 0));
  p.send_loud(safe, 0, 4);
  safe.plan(p.at(p.nothing, 4));
  safe.send(4, p.silent);
  safe.plan(p.at(p.touch, 5));
  safe.send(5, p.loud);
  EXPECT_EQ(p.spy.loudest, (std::vector<float>{0.25f, 0.5f, 0.75f, 1.0f, 0.75f, 1.0f}));
}

TEST(SafeLink, AModulationsOwnSilenceIsNoEnd) {
  Player p;
  SafeLink safe(p.spy, 3, {.ramp_s = 2 * slot_s});
  safe.plan(p.at(p.touch, 0));
  safe.send(0, p.loud);
  safe.send(1, p.silent);
  safe.send(2, p.loud);
  EXPECT_EQ(p.spy.loudest, (std::vector<float>{0.5f, 0.0f, 1.0f}));
}

TEST(SafeLink, SilencesOnDemand) {
  Player p;
  SafeLink safe(p.spy, 3);
  safe.plan(p.at(p.touch, 0));
  safe.send(0, p.loud);
  safe.silence();
  EXPECT_TRUE(p.spy.ended_silent());
  EXPECT_EQ(p.spy.plans.back().voices, 0u);
  EXPECT_EQ(p.spy.slots.back(), 1u);
  EXPECT_EQ(safe.next_slot(), 2u);
}

TEST(SafeLink, RefusesSettingsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Safety& safety : {Safety{.ceiling = 1.01}, Safety{.ceiling = -0.1}, Safety{.ceiling = nan},
                               Safety{.ramp_s = -1}, Safety{.ramp_s = 1.5}, Safety{.ramp_s = nan}}) {
    Player p;
    EXPECT_EQ(palpa::test::thrown_by([&] { SafeLink safe(p.spy, 3, safety); }).code(), Exit::usage);
  }
}

}  // namespace
}  // namespace palpa::session
