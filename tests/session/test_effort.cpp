// The effort that is dropped if frames take too long, decided only from simulated times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "session/plan/scheduler.hpp"
#include "session/watch/effort.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

constexpr double hold_s = 0.1, period_s = 1.0 / 90;
constexpr Effort most{4, 3};

/// A machine that always processes a camera's newest frame, like the loop.
struct Machine {
  /// The duration of a frame that begins at that time with that effort.
  std::function<double(double now_s, const Effort&)> work;
  EffortControl control{hold_s, most};
  double now_s = 1, captured_s = 0;
  std::uint64_t frames = 0;
  std::vector<Effort> changes;
  double silent_s = 0;  ///< total time in which the sound ended before the next plan was there

  void run(double seconds) {
    for (const double end_s = now_s + seconds; now_s < end_s;) {
      const double before_s = captured_s;
      captured_s = std::floor(now_s / period_s) * period_s;  // the newest frame that has arrived
      if (captured_s == before_s) now_s = captured_s += period_s;
      const double takes_s = work(now_s, control.now());
      now_s += takes_s;
      ++frames;
      if (frames > 1) silent_s += std::max(0.0, now_s - (before_s + hold_s));
      if (control.planned({now_s - captured_s, takes_s, captured_s - before_s})) changes.push_back(control.now());
    }
  }
};

/// Pixels take most of the time, foci the rest.
std::function<double(double, const Effort&)> costs(double pixels_s, double foci_s) {
  return [=](double, const Effort& effort) {
    return pixels_s / (effort.pixel_stride * effort.pixel_stride) + foci_s / effort.foci_part;
  };
}

TEST(Effort, IsWholeAsLongAsTheLatencyFits) {
  for (const double ms : {0.5, 5.0, 11.0, 20.0, 30.0, 34.0}) {
    Machine machine{costs(0.8e-3 * ms, 0.2e-3 * ms)};
    machine.run(60);
    EXPECT_TRUE(machine.changes.empty()) << ms;
    EXPECT_TRUE(machine.control.least().whole());
    EXPECT_EQ(machine.control.shed_frames(), 0u);
    EXPECT_LT(machine.silent_s, 1e-9) << ms;
  }
}

TEST(Effort, ShedsPixelsFirstAndThenFociUntilTheLatencyFits) {
  Machine hand{costs(0.250, 0.010)};  // the time for a hand in a large box
  hand.run(2);
  EXPECT_EQ(hand.control.now(), (Effort{3, 1})) << "within a few frames";
  hand.run(58);
  EXPECT_EQ(hand.control.now(), (Effort{3, 1}));
  EXPECT_EQ(hand.changes, (std::vector<Effort>{{2, 1}, {3, 1}}));
  Machine fingers{costs(0.020, 0.090)};  // many fingers, and a solver
  fingers.run(60);
  EXPECT_EQ(fingers.changes.front(), (Effort{2, 1}));
  EXPECT_EQ(fingers.control.now(), (Effort{4, 3}));
  for (Machine* machine : {&hand, &fingers}) {
    const double before_s = machine->silent_s;
    machine->run(60);
    EXPECT_EQ(machine->silent_s, before_s) << "no more gaps";
  }
}

TEST(Effort, TheHoldIsLengthenedLastAndOnlyWhereThatIsAskedFor) {
  const auto slow = [](double seconds) { return [=](double, const Effort&) { return seconds; }; };
  Machine never{slow(0.06)};
  never.run(60);
  EXPECT_EQ(never.control.hold_s(), hold_s);
  EXPECT_EQ(never.control.now(), most);
  EXPECT_TRUE(never.control.exhausted());
  EXPECT_EQ(never.changes.size(), 5u);
  Machine asked{slow(0.06)};
  asked.control = EffortControl(hold_s, most, longest_auto_hold_s);
  asked.run(60);
  EXPECT_EQ(asked.control.now(), most) << "all else first";
  EXPECT_GT(asked.control.hold_s(), 0.13);
  EXPECT_LE(asked.control.hold_s(), 0.2);
  Machine hopeless{slow(1)};
  hopeless.control = EffortControl(hold_s, most, longest_auto_hold_s);
  hopeless.run(60);
  EXPECT_EQ(hopeless.control.hold_s(), 0.2) << "no longer than that";
  EXPECT_TRUE(hopeless.control.exhausted());
  Machine busy{[](double now_s, const Effort&) { return now_s < 20 ? 0.06 : 0.005; }};
  busy.control = EffortControl(hold_s, most, longest_auto_hold_s);
  busy.run(60);
  EXPECT_EQ(busy.control.hold_s(), hold_s) << "and no longer than it takes";
  EXPECT_TRUE(busy.control.now().whole()) << "the machine is quiet again";
  EXPECT_EQ(busy.control.least(), most) << "what was shed is remembered for the report";
  EXPECT_GT(busy.control.shed_frames(), 0u);
  EXPECT_GT(busy.control.most_hold_s(), hold_s);
}

TEST(Effort, DoesNotOscillate) {
  // Slightly too much at full effort, and easy at less: it tries full effort now and then, and less and less often.
  for (const double pixels_s : {0.038, 0.045, 0.060, 0.120, 0.2}) {
    Machine machine{costs(pixels_s, 0.005)};
    machine.run(3600);
    EXPECT_LT(machine.changes.size(), 40u) << pixels_s;
    const std::size_t before = machine.changes.size();
    machine.run(600);
    EXPECT_LE(machine.changes.size() - before, 6u) << pixels_s;
  }
}

TEST(Effort, IsWholeWhereSheddingIsOfNoUse) {
  struct Case {
    const char* where;
    Effort most;
    FrameTimes usual, two_of_fifty;
  };
  const FrameTimes quick{0.005, 0.005, period_s}, dawdling{0.3, 0.3, period_s}, rare{0.020, 0.010, 0.2}, slow{1, 1, 1};
  for (const Case& c : {Case{"a frame or two dawdle", most, quick, dawdling},
                        {"the camera is slow", most, rare, rare},
                        {"the planner can shed nothing", {}, slow, slow}}) {
    EffortControl control(hold_s, c.most);
    for (int frame = 0; frame < 10'000; ++frame)
      ASSERT_FALSE(control.planned(frame % 50 < 2 ? c.two_of_fifty : c.usual)) << c.where;
    EXPECT_TRUE(control.least().whole());
    EXPECT_EQ(control.shed_frames(), 0u);
    EXPECT_EQ(control.exhausted(), c.most.whole());
  }
}

/// The warnings about 300 frames of these durations.
std::string said_of_frames(const std::function<double(int frame, const Effort&)>& takes) {
  EffortControl control(hold_s, most);
  ShedReport report(hold_s);
  return test::stderr_of([&] {
    for (int frame = 0; frame < 300; ++frame) {
      const double takes_s = takes(frame, control.now());
      control.planned({takes_s, takes_s, takes_s});
      report.planned(control);
    }
    report.end(control);
  });
}

TEST(Effort, WhatWasShedIsToldOnceWithWhatWouldHelp) {
  const std::string said =
      said_of_frames([](int, const Effort& now) { return 0.25 / (now.pixel_stride * now.pixel_stride); });
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_CONTAINS(said,
                  "from the capture of a frame to the drives of the next one it took 500 ms, more than 80 % of "
                  "the hold of 100 ms");
  EXPECT_CONTAINS(said, "only every 3rd pixel of every 3rd row was used");
  EXPECT_CONTAINS(said, "--hold");
  EXPECT_EQ(to_text(Effort{2, 3}),
            "only every 2nd pixel of every 2nd row was used and fingers had one in 3 of their foci");
}

/// Later frames that took less, or less time than the hold for one frame, do not contradict it.
TEST(Effort, WhatIsToldIsWhatWasTooLong) {
  const std::string said = said_of_frames([](int frame, const Effort&) { return frame < 3 ? 0.045 : 0.01; });
  EXPECT_CONTAINS(said, "it took 90 ms, more than 80 % of the hold of 100 ms, so only every 2nd pixel");
}

/// A finger with ten foci; those in `empty` have no contacts.
touch::Touch ten_foci(const std::vector<std::uint32_t>& empty = {}) {
  touch::Touch touch;
  touch.finger_count = 1;
  touch::Finger& finger = touch.fingers.emplace_back();
  for (std::uint32_t n = 0; n < 10; ++n) {
    const double angle = 0.2 * 3.14159265 * n;
    finger.foci.push_back({{0.004 * std::cos(angle), 0, 0.004 * std::sin(angle)}, 5});
  }
  for (const std::uint32_t n : empty)
    finger.foci[n] = {{std::nanf(""), 0, 0}, 0};
  return touch;
}

TEST(Effort, FewerFociAreStillAScheduleOfAllOfThem) {
  geometry::Solid solid;
  const std::vector<geometry::Solid> solids{solid};
  for (const std::uint32_t asked : {0u, 3u, 7u}) {
    ScheduleOptions options;
    if (asked != 0) options.voice.stride = asked;
    Scheduler scheduler("scene", solids, {}, options);
    array::Schedule schedule;
    for (const auto& [part, foci] : {std::pair(1u, 10u), {2u, 5u}, {3u, 3u}, {4u, 3u}, {1u, 10u}}) {
      scheduler.thin_foci(part);
      scheduler.make(ten_foci(), 1, schedule);
      ASSERT_EQ(schedule.voice_count, 1u);
      const array::Voice& voice = schedule.voices[0];
      EXPECT_EQ(voice.foci.size(), foci);
      std::vector<std::uint32_t> sorted(voice.order.begin(), voice.order.end()), all(foci);
      std::sort(sorted.begin(), sorted.end());
      std::iota(all.begin(), all.end(), 0u);
      EXPECT_EQ(sorted, all) << "each once: stride " << asked << ", part " << part;
      EXPECT_EQ(voice.dwell_s, 1.5e-3);
      EXPECT_EQ(voice.modulation_hz, 0);
    }
  }
}

/// The rule of docs/conventions.md: the nearest sector by angle; if two are equally near, the lower index.
TEST(Effort, FewerFociTakeTheSameSectorForAnEmptyOneAsAllFociDo) {
  geometry::Solid solid;
  const std::vector<geometry::Solid> solids{solid};
  Scheduler whole("scene", solids, {}, {}), thinned("scene", solids, {}, {});
  thinned.thin_foci(2);
  array::Schedule all, fewer;
  for (std::uint32_t empty = 1; empty < (1u << 10) - 1; ++empty) {
    std::vector<std::uint32_t> sectors;
    for (std::uint32_t n = 0; n < 10; ++n)
      if ((empty >> n & 1) != 0) sectors.push_back(n);
    whole.make(ten_foci(sectors), 1, all);
    thinned.make(ten_foci(sectors), 1, fewer);
    ASSERT_EQ(all.voices[0].foci.size(), 10u);
    ASSERT_EQ(fewer.voices[0].foci.size(), 5u);
    for (std::uint32_t f = 0; f < 5; ++f)
      EXPECT_EQ(fewer.voices[0].foci[f], all.voices[0].foci[2 * f]) << "focus " << f << ", empty sectors " << empty;
  }
}

}  // namespace
}  // namespace palpa::session
