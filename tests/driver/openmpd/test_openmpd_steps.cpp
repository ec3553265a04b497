// Steps between drives: what the boards show of them, and how long silence waits for their queue. Time advances only as
// a test lets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
constexpr std::size_t frame_bytes = 512;

array::Drive drive_to(const array::Layout& layout, double x) {
  return focus_drive(layout, {x, 0.004, 0.12}, array::Weighting::uniform);
}

bool sounds(const openmpd::Pulses& pulses) {
  return std::ranges::any_of(pulses, [](const auto& pulse) { return pulse.width > 0; });
}

/// Frames that the first board shows from now on.
struct Shown {
  explicit Shown(OpenMpdRig& rig) {
    rig.fpga(0).on_shown([this](double time_s, const openmpd::Pulses& pulses) { frames.emplace_back(time_s, pulses); });
  }
  std::vector<std::pair<double, openmpd::Pulses>> frames;
};

TEST(OpenMpdSteps, TakeTheSlotButForItsLastStepByTheShorterWay) {
  for (const double slot_s : {1.5e-3, 0.5e-3, 0.3e-3}) {
    OpenMpdRig rig({"EMU1", "EMU2"});
    rig.steps = true;
    rig.slot_s = slot_s;
    rig.open();
    array::Drive from = drive_to(rig.layout, 0), to = drive_to(rig.layout, 0.01);
    for (std::size_t t = 0; t < to.size(); ++t)
      to[t].amplitude = 0.3f + 0.6f * static_cast<float>(t % 7) / 6;
    from[3].amplitude = to[5].amplitude = 0;
    rig.play(from, 10 * slot_s);
    Shown shown(rig);
    const double begin_s = rig.clock.now_s();
    rig.play(to, slot_s);
    const auto steps = static_cast<std::size_t>(std::lround(slot_s / 0.1e-3)) - 1;
    ASSERT_EQ(shown.frames.size(), steps) << slot_s;
    for (std::size_t step = 1; step <= steps; ++step) {
      const auto& [time_s, pulses] = shown.frames[step - 1];
      EXPECT_NEAR(time_s - begin_s, 0.1e-3 * static_cast<double>(step - 1), 26e-6);
      const array::Drive heard = openmpd::heard_drive(pulses, {});
      const double part = static_cast<double>(step) / static_cast<double>(steps);
      for (std::size_t t = 0; t < heard.size(); ++t) {
        const double amplitude = std::lerp(double{from[t].amplitude}, double{to[t].amplitude}, part);
        // The next lower of the board's widths.
        EXPECT_NEAR(heard[t].amplitude, amplitude, 0.026) << t << " at step " << step;
        if (heard[t].amplitude < 0.03) continue;
        const double way = std::arg(std::polar(1.0, double{to[t].phase} - from[t].phase));
        const double phase = t == 3 ? to[t].phase : t == 5 ? from[t].phase : from[t].phase + way * part;
        EXPECT_LT(std::abs(std::polar(1.0, phase) - std::polar(1.0, double{heard[t].phase})), 0.05) << t;
      }
    }
    OpenMpdRig jumps({"EMU1", "EMU2"});
    jumps.open();
    jumps.play(to, jumps.slot_s);
    EXPECT_EQ(rig.fpga(0).pulses(), jumps.fpga(0).pulses()) << "where they end";
    EXPECT_EQ(rig.fpga(1).pulses(), jumps.fpga(1).pulses());
    EXPECT_EQ(rig.fpga(0).frames(), rig.fpga(1).frames());
    EXPECT_EQ(rig.board->counts().completed.drives, 11u) << "a drive of several steps is one";
    EXPECT_EQ(rig.violations(), "");
    EXPECT_TRUE(rig.notes.warnings.empty());
    const array::Changes model = array::changes_of(array::find_board_type("openmpd"), {.slot_s = slot_s});
    EXPECT_EQ(model.phase_steps, steps) << "what --audible assumes";
    EXPECT_EQ(model.amplitude_steps, steps);
    EXPECT_EQ(model.step_periods, 4u);
  }
}

TEST(OpenMpdSteps, NeverQueueMoreThanASlotAndNeverLeaveOutTheLastFrame) {
  // A board that takes its bytes whenever it likes, beside a guard that is late at random. Both clocks are the test's.
  std::mt19937 random(1);
  const auto number = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
  for (const double slot_s : {1.5e-3, 0.3e-3, 4e-3}) {
    OpenMpdRig rig({"EMU1", "EMU2"});
    rig.steps = true;
    rig.slot_s = slot_s;
    rig.open();
    const std::array<array::Drive, 3> drives{drive_to(rig.layout, 0), drive_to(rig.layout, 0.01),
                                             drive_to(rig.layout, -0.02)};
    const std::size_t slot_frames = slot_s < 1e-3 ? 3 : 15;
    std::size_t most = 0, whole = 0;
    for (int turn = 0; turn < 3000; ++turn) {
      rig.faults[0]->takes_nothing = number(3) == 0;
      rig.faults[1]->takes_nothing = number(7) == 0;
      if (number(2) == 0) {
        const std::uint64_t before = rig.board->connections()[0]->frames();
        rig.board->play(rig.slot++, drives[static_cast<std::size_t>(number(3))]);
        whole += rig.board->connections()[0]->frames() - before == slot_frames - 1 ? 1 : 0;
      } else {
        rig.board->tend();
      }
      rig.look();
      most = std::max({most, rig.fpga(0).buffered() / frame_bytes, rig.fpga(1).buffered() / frame_bytes});
      rig.clock.sleep_s(1e-4 * number(slot_s < 1e-3 ? 6 : 20));
    }
    EXPECT_LE(most, slot_frames) << slot_s;
    EXPECT_GT(most, slot_frames / 3) << "it is a queue at times";
    EXPECT_GT(whole, 50u) << "and at times there is room for all steps";
    rig.faults[0]->takes_nothing = rig.faults[1]->takes_nothing = false;
    rig.tend_for(0.02);
    rig.board->play(rig.slot++, drives[1]);
    rig.tend_for(0.02);
    OpenMpdRig jumps({"EMU1", "EMU2"});
    jumps.open();
    jumps.play(drives[1], jumps.slot_s);
    EXPECT_EQ(rig.fpga(0).pulses(), jumps.fpga(0).pulses());
    EXPECT_EQ(rig.fpga(0).frames(), rig.fpga(1).frames());
    EXPECT_EQ(rig.violations(), "");
  }
}

/// When the board falls silent after silence was asked for, with bytes that are taken late at random.
double silent_s(bool steps, unsigned seed, bool by_a_drive) {
  std::mt19937 random(seed);
  const auto number = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
  OpenMpdRig rig;
  rig.steps = steps;
  rig.open();
  Shown shown(rig);
  const array::Drive one = drive_to(rig.layout, 0), other = drive_to(rig.layout, 0.01);
  const int turns = 40 + number(60);
  for (int turn = 0; turn < turns; ++turn) {
    rig.faults[0]->takes_nothing = number(4) == 0;
    if (number(5) > 0) rig.board->play(rig.slot++, turn % 2 == 0 ? one : other);
    rig.board->tend();
    rig.clock.sleep_s(1e-4 * number(16));
  }
  const bool held = number(2) == 0;
  rig.faults[0]->takes_nothing = held;
  const double asked_s = rig.clock.now_s();
  if (by_a_drive) {
    rig.board->play(rig.slot++, array::Drive(256, {0, 0}));
  } else {
    rig.board->all_off();
  }
  for (int i = 0; i < 60; ++i) {
    rig.clock.sleep_s(1e-4);
    if (i == 9) rig.faults[0]->takes_nothing = false;
    rig.board->tend();
  }
  rig.look();
  EXPECT_FALSE(rig.sounds());
  EXPECT_FALSE(rig.fpga(0).sounds_behind());
  double last_s = asked_s;
  for (std::size_t i = 0; i < shown.frames.size(); ++i) {
    if (!sounds(shown.frames[i].second) && (i == 0 || sounds(shown.frames[i - 1].second)))
      last_s = std::max(last_s, shown.frames[i].first);
  }
  return last_s - asked_s;
}

TEST(OpenMpdSteps, SilenceComesAtMostASlotAndAFrameLaterThanAfterJumps) {
  double most = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    for (const bool by_a_drive : {false, true}) {
      const double with = silent_s(true, seed, by_a_drive), without = silent_s(false, seed, by_a_drive);
      EXPECT_LE(with - without, 1.6e-3) << "seed " << seed;
      most = std::max(most, with - without);
    }
  }
  EXPECT_GT(most, 0.5e-3) << "it waits for the queue at times";
}

TEST(OpenMpdSteps, GoOnAfterTroubleAndAfterSilence) {
  OpenMpdRig rig({"EMU1", "EMU2"});
  rig.steps = true;
  rig.open();
  const array::Drive drive = drive_to(rig.layout, 0);
  rig.play(drive, 0.03);
  rig.faults[1]->stalled = true;
  rig.play(drive, 3);
  EXPECT_TRUE(rig.sounds());
  rig.board->all_off();
  EXPECT_TRUE(rig.silent_after(1.7e-3));
  const std::uint64_t before = rig.fpga(0).frames();
  rig.play(drive, 2 * rig.slot_s);
  EXPECT_EQ(rig.fpga(0).frames(), before + 2 * 14);
  EXPECT_EQ(rig.fpga(0).frames_in_step(), rig.fpga(1).frames_in_step());
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  EXPECT_TRUE(rig.silent_after(2e-3));
  for (const auto& emulator : rig.emulators)
    EXPECT_FALSE(emulator->fpga().sounds_behind());
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdSteps, AreFewerOrNoneWhereSomethingForbidsThemAndItIsSaidOnce) {
  const auto frames_of = [](OpenMpdRig& rig, const std::string& line) {
    rig.steps = true;
    rig.open();
    EXPECT_EQ(rig.notes.warnings.size(), line.empty() ? 0u : 1u);
    if (!line.empty() && !rig.notes.warnings.empty()) {
      EXPECT_CONTAINS(rig.notes.warnings[0], line);
    }
    rig.tend_for(0.01);  // the frames of the opening are gone
    const openmpd::Fpga& last = rig.fpga(rig.emulators.size() - 1);
    const std::uint64_t before = last.frames();
    rig.play(array::Drive(rig.layout.transducers.size(), {1, 0}), rig.slot_s);
    return last.frames() - before;
  };
  OpenMpdRig nulls, brief, shortest, longer, longest;
  nulls.nulls = true;
  EXPECT_EQ(frames_of(nulls, "with nulls, phases jump"), 1u);
  brief.slot_s = 0.25e-3;
  EXPECT_EQ(frames_of(brief, "a dwell of 0.25 ms has no room for steps"), 1u);
  shortest.slot_s = 0.3e-3;
  EXPECT_EQ(frames_of(shortest, ""), 2u);
  longer.slot_s = 1.6e-3;
  EXPECT_EQ(frames_of(longer, "in the first 1.4 ms of a dwell of 1.6 ms, because silence must not wait longer"), 14u);
  longest.slot_s = 50e-3;
  EXPECT_EQ(frames_of(longest, "silence must not wait longer"), 14u);
  // Sixteen boards on one bus, which carries 7 frames of each in a slot; on two of them, 14.
  for (const auto& [buses, frames] : {std::pair(1u, 7u), std::pair(2u, 14u)}) {
    OpenMpdRig many;
    many.take_sixteen(buses);
    EXPECT_EQ(frames_of(many, buses == 1 ? "the USB bus carries no more steps" : ""), frames);
  }
  // Steps off, nulls: not a word.
  OpenMpdRig off;
  off.nulls = true;
  off.open();
  EXPECT_TRUE(off.notes.warnings.empty());
}

/// The A-weighted level, dB, of the last 30 ms that a board showed, by code of this test's own.
double heard_db(const Shown& shown, double end_s, double q) {
  constexpr std::size_t count = 1200;
  constexpr double period_s = 25e-6, pi = std::numbers::pi;
  std::vector<std::complex<double>> output(256);
  std::vector<double> power;
  std::size_t next = 0;
  array::Drive drive(256, {0, 0});
  for (std::size_t k = 0; k < 2 * count; ++k) {
    const double now_s = end_s - static_cast<double>(2 * count - k) * period_s;
    for (; next < shown.frames.size() && shown.frames[next].first <= now_s + 1e-9; ++next)
      drive = openmpd::heard_drive(shown.frames[next].second, {});
    double sum = 0;
    for (std::size_t t = 0; t < output.size(); ++t) {
      output[t] += (std::polar<double>(drive[t].amplitude, drive[t].phase) - output[t]) * (1 - std::exp(-pi / q));
      sum += std::norm(output[t]);
    }
    if (k >= count) power.push_back(sum * 4.386 * 4.386 * pi * 0.291 / (1.204 * 343.2));
  }
  double energy = 0;
  for (std::size_t n = 1; n < count / 2; ++n) {
    std::complex<double> line = 0;
    for (std::size_t k = 0; k < count; ++k)
      line += power[k] * std::polar(1.0 / count, -2 * pi * static_cast<double>(n * k % count) / count);
    const double hz = static_cast<double>(n) / (count * period_s), f2 = hz * hz;
    const double weight = std::pow(10, 0.1) * 1.486969e8 * f2 * f2 /
                          ((f2 + 424.3) * std::sqrt((f2 + 11589.0) * (f2 + 544440.7)) * (f2 + 1.486969e8));
    const double pascals = 2 * pi * hz * std::abs(line) * 1.2 / (2 * pi * 343.2 * 343.2 * 0.72);
    energy += 2 * std::pow(pascals * weight, 2);
  }
  return 10 * std::log10(energy / 4e-10);
}

TEST(OpenMpdSteps, AreQuieterByWhatTheirPageSays) {
  const auto levels = [](bool steps, double ramp_s, double slot_s, bool still) {
    OpenMpdRig rig;
    rig.steps = steps;
    rig.ramp_s = ramp_s;
    rig.slot_s = slot_s;
    rig.open();
    Shown shown(rig);
    constexpr double pi = std::numbers::pi;
    const int slots = static_cast<int>(std::lround(75e-3 / slot_s));
    for (int i = 0; i < slots; ++i) {
      const double angle = 2 * pi * (3 * i % 10) / 10, radius = still ? 0 : 0.0175;
      array::Drive drive = focus_drive(rig.layout, {radius * std::cos(angle), radius * std::sin(angle), 0.15});
      for (array::TransducerDrive& one : drive)
        one.amplitude *=
            still ? static_cast<float>(std::sqrt(0.5 + 0.5 * std::sin(2 * pi * 200 * (i + 0.5) * slot_s))) : 1;
      rig.play(drive, slot_s);
    }
    return std::array{heard_db(shown, rig.clock.now_s(), 20), heard_db(shown, rig.clock.now_s(), 40)};
  };
  const auto jumps = levels(false, 0, 1.5e-3, false), ramp = levels(false, 20e-3, 1.5e-3, false),
             steps = levels(true, 0, 1.5e-3, false), coarse = levels(false, 0, 1.5e-3, true),
             fine = levels(true, 0, 0.3e-3, true);
  const char* const names[]{"q20", "q40"};
  for (std::size_t q = 0; q < 2; ++q) {
    EXPECT_GT(jumps[q] - steps[q], 20);
    EXPECT_GT(ramp[q] - steps[q], 8);
    EXPECT_GT(coarse[q] - fine[q], 10);
    RecordProperty(std::string("jumps_minus_steps_") + names[q], std::to_string(jumps[q] - steps[q]));
    RecordProperty(std::string("ramp_minus_steps_") + names[q], std::to_string(ramp[q] - steps[q]));
    RecordProperty(std::string("still_") + names[q], std::to_string(coarse[q] - fine[q]));
    RecordProperty(std::string("jumps_") + names[q], std::to_string(jumps[q]));
  }
}

}  // namespace
}  // namespace palpa::test
