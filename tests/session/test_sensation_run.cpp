// A sensation on a link: what it gets, and when it falls silent. By a clock of the test's own.
#include "session/sensation_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <span>
#include <vector>

#include "base/error.hpp"
#include "fakes.hpp"
#include "sensation/pattern_text.hpp"
#include "stepped_clock.hpp"
#include "support/captured.hpp"
#include "support/occurrences.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

constexpr double slot_s = 1e-3;

/// A focus that moves along x, 1 mm in each slot, and is loud as `gain` says.
sensation::FunctionSensation moving(std::function<double(double)> gain = [](double) { return 1.0; }) {
  return sensation::FunctionSensation([gain](std::span<const double> times, auto& places, auto& gains) {
    for (const double time_s : times) {
      places.push_back({time_s, 0.1, 0});
      gains.push_back(gain(time_s));
    }
  });
}

/// What a link hears: the slots, and how loud each is.
struct HeardLink final : Link {
  std::vector<std::pair<std::uint64_t, float>> heard;
  std::vector<array::Schedule> plans;
  std::vector<Slots> slots;
  bool lists = false;
  std::function<void(std::uint64_t)> before = [](std::uint64_t) {};

  void plan(const PlayedPlan& plan) override {
    plans.push_back(plan.schedule);
    slots.push_back(plan.slots);
  }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    before(slot);
    heard.emplace_back(slot, test::loudest_of(drive));
  }
  bool plays_plans() const override { return lists; }
  std::size_t sounding() const {
    return static_cast<std::size_t>(std::ranges::count_if(heard, [](const auto& one) { return one.second > 0; }));
  }
};

struct Playing {
  test::SteppedClock clock;
  array::Layout layout = test::small_layout();
  HeardLink link;
  SensationControl control;
  HandPlace hand;
  std::atomic<bool> stop{false};
  SensationSetting setting{
      .output = {.layout = layout, .drive = {.weighting = array::Weighting::uniform}, .slot_s = slot_s}};

  OutputStats run(sensation::Sensation& sensation) {
    return run_sensation(sensation, control, link, setting, stop, no_observer, clock);
  }
};

TEST(SensationRun, PlaysEachSlotAndEndsSilentAtItsTime) {
  Playing playing;
  playing.setting.end_s = 0.25;
  auto sensation = moving();
  std::size_t running = 0;
  playing.link.before = [&](std::uint64_t) { running += playing.control.runs() ? 1 : 0; };
  EXPECT_FALSE(playing.control.runs());
  const OutputStats stats = playing.run(sensation);
  EXPECT_FALSE(playing.control.runs()) << "another may begin";
  EXPECT_EQ(running, playing.link.heard.size());
  EXPECT_EQ(playing.link.sounding(), 250U);
  EXPECT_EQ(playing.link.heard.back().second, 0);
  EXPECT_EQ(stats.skipped_slots, 0U);
  EXPECT_EQ(stats.drives - stats.silent_drives, 250U);
  for (const array::Schedule& schedule : playing.link.plans) {
    EXPECT_EQ(schedule.once, schedule.voice_count > 0);
  }
}

TEST(SensationRun, EachSlotHasThePlaceOfItsTime) {
  for (const bool listed : {false, true}) {
    Playing playing;
    playing.setting.end_s = 0.2;
    playing.setting.listed = playing.link.lists = listed;
    std::vector<std::pair<std::uint64_t, Vec3>> places;
    auto sensation = moving();
    playing.link.before = [&](std::uint64_t slot) {
      const array::Schedule& schedule = playing.link.plans.empty() ? array::Schedule{} : playing.link.plans.back();
      if (schedule.voice_count == 0) return;
      std::vector<array::SlotFocus> foci;
      array::foci_of_slot(schedule, slot, foci);
      ASSERT_EQ(foci.size(), 1U);
      if (places.empty() && foci[0].position.y == 0) return;  // a slot before it begins, which is silent
      places.emplace_back(slot, foci[0].position);
    };
    playing.run(sensation);
    ASSERT_GE(places.size(), 200U);
    const std::uint64_t first = places[0].first;
    for (std::size_t i = 0; i < 200; ++i) {
      EXPECT_EQ(places[i].first, first + i);
      EXPECT_NEAR(places[i].second.x, static_cast<double>(i) * slot_s, 1e-9) << listed;
    }
    for (const Slots& slots : playing.link.slots) {  // a plan has an end, and does not come round to its beginning
      if (listed && slots.cycle.is_listed()) {
        EXPECT_EQ(slots.cycle.length, listed_slots);
        EXPECT_LE(slots.count(), listed_slots + 1U);
      }
    }
  }
}

TEST(SensationRun, GainsAreThoseOfTheirSlots) {
  Playing playing;
  playing.setting.end_s = 0.1;
  auto sensation = moving([](double time_s) { return time_s < 0.05 ? 0.25 : 0.75; });
  playing.run(sensation);
  std::size_t quiet = 0, loud = 0;
  for (const auto& [slot, amplitude] : playing.link.heard) {
    quiet += std::abs(amplitude - 0.25F) < 1e-6F ? 1 : 0;
    loud += std::abs(amplitude - 0.75F) < 1e-6F ? 1 : 0;
  }
  EXPECT_EQ(quiet, 50U);
  EXPECT_EQ(loud, 50U);
}

TEST(SensationRun, PausesStartsAgainAndStartsElsewhere) {
  Playing playing;
  auto sensation = moving();
  std::vector<double> from;
  std::uint64_t silent_since = 0, silent_until = 1;
  playing.link.before = [&](std::uint64_t slot) {
    if (slot == 50) playing.control.pause();
    if (slot == 100) playing.control.play(7);
    if (slot == 150) playing.control.play(2, 0.02);
    if (slot == 200) playing.stop = true;
    if (slot == 90) silent_since = playing.link.sounding();
    if (slot == 99) silent_until = playing.link.sounding();
    if (slot == 140 || slot == 195) from.push_back(playing.control.newest(1).at(0).pattern_s);
  };
  playing.run(sensation);
  EXPECT_EQ(silent_until, silent_since);
  ASSERT_EQ(from.size(), 2U);
  EXPECT_NEAR(from[0], 7 + 0.03, 0.015);
  EXPECT_NEAR(from[1], 2 + 0.015, 0.015);
  EXPECT_EQ(playing.link.heard.back().second, 0);
}

TEST(SensationRun, StartsAtNoTimeWithoutEnd) {
  SensationControl control;
  for (const double time_s : {std::nan(""), HUGE_VAL, -1.1e6, 1e18}) {
    EXPECT_ERROR(control.play(time_s), Exit::usage, "starts at a time of at most 1e+06 s");
    EXPECT_ERROR(control.play(0, time_s), Exit::usage, "starts at a time");
  }
  EXPECT_EQ(control.now().number, 0U);
}

TEST(SensationRun, PlaysOnAHandAndIsSilentWhenItIsLost) {
  Playing playing;
  playing.setting.hand = &playing.hand;
  playing.setting.output.hold_s = 0.03;
  auto sensation = moving();
  playing.link.before = [&](std::uint64_t slot) {
    Transform pose(1.0);
    pose[3] = Vec4(0, 0.02, 0.05, 1);
    if (slot >= 20 && slot < 100 && slot % 10 == 0) playing.hand.see(pose, playing.clock.now());
    if (slot == 150) playing.hand.see(pose, playing.clock.now());
    if (slot == 165) playing.hand.lose();
    if (slot == 200) playing.stop = true;
  };
  playing.run(sensation);
  const auto sounds = [&](std::uint64_t slot) {
    const auto found = std::ranges::find(playing.link.heard, slot, &std::pair<std::uint64_t, float>::first);
    return found != playing.link.heard.end() && found->second > 0;
  };
  EXPECT_FALSE(sounds(15));  // no hand yet
  EXPECT_TRUE(sounds(40));
  EXPECT_TRUE(sounds(115));   // the last frame came at slot 90
  EXPECT_FALSE(sounds(121));  // and holds for 30 ms
  EXPECT_TRUE(sounds(162));
  EXPECT_FALSE(sounds(178));  // a frame without a hand
  const auto point = playing.control.newest(1);
  EXPECT_NEAR(point.at(0).pattern_s, 0.19, 0.02);  // its time went on
  EXPECT_EQ(point.at(0).gain, 0);
}

TEST(SensationRun, FollowsTheHandOrNotThroughStartsAndPauses) {
  Playing playing;
  playing.setting.hand = &playing.hand;
  auto sensation = moving();
  std::vector<std::pair<std::uint64_t, bool>> on_hand;
  playing.link.before = [&](std::uint64_t slot) {
    if (slot % 5 == 0) playing.hand.see(glm::translate(Transform(1.0), Vec3(0, 1, 0)), playing.clock.now());
    if (slot == 60 || slot == 310) playing.control.follow(false);
    if (slot == 260) playing.control.follow(true);
    for (const std::uint64_t start : {110U, 210U, 360U}) {
      if (slot == start) playing.control.play(0);
    }
    if (slot == 160) playing.control.pause();
    if (slot == 410) playing.stop = true;
    const auto newest = playing.control.newest(1);
    if (slot % 50 == 0 && !newest.empty()) on_hand.emplace_back(slot, newest[0].place_m.y > 0.5);
  };
  playing.run(sensation);
  const std::vector<std::pair<std::uint64_t, bool>> expected{{50, true},   {100, false}, {150, false}, {200, false},
                                                             {250, false}, {300, true},  {350, false}, {400, false}};
  EXPECT_EQ(on_hand, expected);
}

TEST(SensationRun, AHandTurnsItOrLeavesItUpright) {
  const sensation::Point point{.place_m = {0.01, 0.02, 0.2}, .height_m = 0.2};
  Transform hand{Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0.1, 0.2, 0.3, 1)};
  const auto expect = [&](const SensationSetting& setting, const std::optional<Transform>& on, const Vec3& place) {
    EXPECT_LT(glm::length(placed(point, setting, on) - place), 1e-12);
  };
  Playing playing;
  expect(playing.setting, std::nullopt, {0.01, 0.02, 0.2});
  expect(playing.setting, hand, {0.08, 0.21, 0.3});
  playing.setting.upright = true;
  expect(playing.setting, hand, {0.11, 0.22, 0.3});
  playing.setting.at_m = Vec3(1, 2, 3);
  expect(playing.setting, std::nullopt, {1.01, 2.02, 3});
}

TEST(SensationRun, FallsSilentIfNoPlanComesAndGoesOnWithItsTime) {
  Playing playing;
  playing.setting.end_s = 1;
  int calls = 0;
  sensation::FunctionSensation slow([&](std::span<const double> times, auto& places, auto& gains) {
    if (++calls == 10) playing.clock.sleep(0.3);
    for (const double time_s : times) {
      places.push_back({time_s, 0.1, 0});
      gains.push_back(1);
    }
  });
  playing.run(slow);
  std::size_t longest = 0, now = 0;
  for (const auto& [slot, amplitude] : playing.link.heard) {
    now = amplitude > 0 ? 0 : now + 1;
    if (slot > 10 && slot < 900) longest = std::max(longest, now);
  }
  EXPECT_GE(longest, 190U);
  EXPECT_LE(longest, 230U);
}

TEST(SensationRun, IsSilentWhileItIsFasterThanArraysPlay) {
  Playing playing;
  const std::string brush = test::brush(
      "circle", fmt::format(R"("radius":{},"am_freq":{},"stm_freq":{})", test::f64(5), test::f64(0), test::param("f")));
  const test::PatternText text{
      .keyframes = test::key("standard", 0, test::coords(0, 0, 0) + test::intensity(test::f64(1)) + brush),
      .definitions = R"("f":{"default":100,"step":1})"};
  sensation::PatternSensation circle(sensation::parse_pattern(text.text(), "p"));
  playing.link.before = [&](std::uint64_t slot) {
    if (slot == 50 || slot == 150) circle.set_parameter("f", slot == 50 ? 500.5 : 600);
    if (slot == 100 || slot == 180) circle.set_parameter("f", 500);
    if (slot == 230) playing.stop = true;
  };
  const std::string told = test::stderr_of([&] { playing.run(circle); });
  EXPECT_EQ(test::occurrences(told, "the sensation now has a brush or a modulation of 500.5 Hz"), 1U) << told;
  EXPECT_EQ(test::occurrences(told, "the sensation now turns at 500 Hz, so one turn has 2 places"), 1U) << told;
  EXPECT_EQ(test::occurrences(told, "warning"), 2U) << told;
  const auto all = [&](std::uint64_t from, std::uint64_t to, bool sound) {
    for (std::uint64_t slot = from; slot < to; ++slot)
      EXPECT_EQ(playing.link.heard.at(slot).second > 0, sound) << slot;
  };
  all(30, 50, true);
  all(75, 100, false);
  all(125, 150, true);
  all(175, 180, false);
  all(205, 230, true);
}

TEST(SensationRun, RandomIntensitiesFollowTheSeed) {
  const std::string random =
      fmt::format(R"(,"intensity":{{"intensity":{{"name":"random","params":{{"min":{},"max":{}}}}},{}}})",
                  test::f64(0.25), test::f64(0.5), test::transition_text("linear"));
  const test::PatternText text{.keyframes = test::key("standard", 0, test::coords(0, 0, 0) + random)};
  const auto of = [&](std::uint64_t seed, bool ahead) {
    Playing playing;
    playing.setting.seed = seed;
    playing.setting.end_s = 0.1;
    sensation::PatternSensation sensation(sensation::parse_pattern(text.text(), "p"));
    std::vector<double> gains;
    if (ahead) {
      for (const sensation::Point& point : points_of_slots(sensation, playing.setting, 100))
        gains.push_back(point.gain);
    } else {
      playing.run(sensation);
      for (const auto& [slot, amplitude] : playing.link.heard) {
        if (amplitude > 0) gains.push_back(amplitude);
      }
    }
    EXPECT_EQ(gains.size(), 100U);
    return gains;
  };
  for (const bool ahead : {false, true}) {
    EXPECT_EQ(of(7, ahead), of(7, ahead)) << ahead;
    EXPECT_NE(of(7, ahead), of(0, ahead)) << ahead;
  }
}

TEST(SensationRun, AnErrorIsToldAfterSilence) {
  Playing playing;
  sensation::FunctionSensation broken([&](std::span<const double> times, auto& places, auto& gains) {
    if (times.back() > 0.15) throw failure("the function fails");
    places.assign(times.size(), Vec3(0, 0.1, 0));
    gains.assign(times.size(), 1);
  });
  EXPECT_ERROR(playing.run(broken), Exit::failed, "the function fails");
  EXPECT_GT(playing.link.sounding(), 0U);
  EXPECT_EQ(playing.link.heard.back().second, 0);
}

TEST(SensationRun, WarnsOnceOfPlacesThatAreOfNoUse) {
  Playing playing;
  playing.setting.end_s = 0.2;
  sensation::FunctionSensation far([](std::span<const double> times, auto& places, auto& gains) {
    for (const double time_s : times) {
      places.push_back(time_s < 0.1 ? Vec3(0, -0.1, 0) : Vec3(0, 200, 0));
      gains.push_back(1);
    }
  });
  const std::string told = test::stderr_of([&] { playing.run(far); });
  EXPECT_CONTAINS(told, "lies behind the array");
  EXPECT_CONTAINS(told, "farther than 100 m from the array: it is silent there");
  EXPECT_EQ(playing.control.newest(1).at(0).gain, 0);
}

}  // namespace
}  // namespace palpa::session
