// Fingers that ask for a pressure: the forward model computes independently what their drives give.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "acoustics/field/pressure.hpp"
#include "acoustics/rigs.hpp"
#include "array/drive.hpp"
#include "array/drive_pass.hpp"
#include "array/layouts/layout.hpp"
#include "array/loudness.hpp"
#include "support/device.hpp"

namespace palpa::array {
namespace {

using acoustics::posed;

Voice& add_ring(Schedule& schedule, const Vec3& centre, double radius, double pressure_pa, std::uint32_t foci = 10) {
  Voice& voice = schedule.add_voice();
  voice.id = schedule.voice_count - 1;
  for (std::uint32_t j = 0; j < foci; ++j) {
    const double angle = 2 * std::numbers::pi * j / foci;
    voice.foci.push_back(centre + radius * Vec3(std::cos(angle), 0, std::sin(angle)));
  }
  fill_order(foci, foci == 10 ? 3 : 1, voice.order);
  voice.pressure_pa = pressure_pa > 0 ? std::optional(pressure_pa) : std::nullopt;
  return voice;
}

void sound_together(Voice& voice) {
  voice.foci_per_slot = static_cast<std::uint32_t>(voice.foci.size());
}

/// A slot of a schedule, driven by its factors.
struct Slot {
  std::vector<SlotFocus> foci;
  Drive drive;
};

Slot slot_of(const Layout& layout, const Schedule& schedule, std::uint32_t number, const Loudness& loudness,
             const DriveOptions& options = {}) {
  Slot slot;
  slot.drive.resize(layout.transducers.size());
  DriveScratch scratch;
  foci_of_slot(schedule, number, slot.foci);
  drive_by_factors(layout, slot.foci, loudness.factors(number), options, slot.drive, scratch);
  return slot;
}

double pressure(const Layout& layout, const Drive& drive, const SlotFocus& focus) {
  return std::abs(acoustics::pressure_at(layout, drive, focus.position));
}

/// For each voice, the pressure of its foci in a slot, weakest and strongest over all slots; and the largest amplitude
/// of all.
struct Heard {
  std::vector<double> least, most;
  double peak = 0;
};

/// Solves slots of a schedule and computes their sound.
Heard solved(const Layout& layout, Schedule& schedule, const DriveOptions& options = {}, std::uint32_t slots = 10) {
  Loudness loudness(layout, options);
  loudness.solve(schedule, slots);
  Heard heard;
  heard.least.assign(schedule.voice_count, 1e9);
  heard.most.assign(schedule.voice_count, 0);
  for (std::uint32_t number = 0; number < slots; ++number) {
    const Slot slot = slot_of(layout, schedule, number, loudness, options);
    for (const TransducerDrive& transducer : slot.drive)
      heard.peak = std::max(heard.peak, static_cast<double>(transducer.amplitude));
    for (const SlotFocus& focus : slot.foci) {
      const double pascals = pressure(layout, slot.drive, focus);
      heard.least[focus.voice] = std::min(heard.least[focus.voice], pascals);
      heard.most[focus.voice] = std::max(heard.most[focus.voice], pascals);
    }
  }
  EXPECT_LE(heard.peak, 1);
  return heard;
}

void expect_pressure(const Heard& heard, std::size_t voice, double pascals, double tolerance = 2e-3) {
  EXPECT_NEAR(heard.least[voice], pascals, tolerance * pascals);
  EXPECT_NEAR(heard.most[voice], pascals, tolerance * pascals);
}

TEST(Loudness, EveryFingerHasWhatItAsksInEverySlotWhateverElseSounds) {
  for (const char* name : {"paper", "openmpd"}) {
    const Layout layout = posed(name);
    const double asked = std::string(name) == "paper" ? 8e3 : 1e3;
    for (const Solver solver : {Solver::naive, Solver::gs_pat}) {
      for (int fingers = 1; fingers <= 5; ++fingers) {
        Schedule schedule;
        for (int f = 0; f < fingers; ++f)
          add_ring(schedule, {0.03 * (f % 3) - 0.03, 0, 0.03 * (f / 3)}, 5e-3, asked / (1 + f % 2));
        const Heard heard = solved(layout, schedule, {.solver = solver});
        for (int f = 0; f < fingers; ++f) {
          expect_pressure(heard, f, asked / (1 + f % 2));
          EXPECT_NEAR(*schedule.voices[f].reached_pa, asked / (1 + f % 2), 2e-3 * asked);
        }
      }
    }
  }
}

TEST(Loudness, AnUnreachableOneLowersNobodyElse) {
  const Layout layout = posed("openmpd");
  const Vec3 near(-0.015, 0, 0);
  Schedule one;
  add_ring(one, near, 5e-3, 2e3);
  expect_pressure(solved(layout, one), 0, 2e3);
  // Too much, too far, behind the board.
  for (const auto& [place, asked] :
       {std::pair(Vec3(0.015, 0, 0), 50e3), std::pair(Vec3(0.8, 0.3, 0), 2e3), std::pair(Vec3(0.015, -0.4, 0), 1e3)}) {
    Schedule two;
    add_ring(two, near, 5e-3, 2e3);
    add_ring(two, place, 5e-3, asked);
    const Heard heard = solved(layout, two);
    expect_pressure(heard, 0, 2e3);
    EXPECT_LT(*two.voices[1].reached_pa, 0.95 * asked);
    EXPECT_GT(*two.voices[1].reached_pa, 0);
    EXPECT_NEAR(heard.least[1], *two.voices[1].reached_pa, 2e-3 * heard.least[1]) << "one factor for all of its foci";
    EXPECT_NEAR(heard.most[1], heard.least[1], 5e-3 * heard.least[1]);
    EXPECT_GT(heard.peak, 0.97) << "it has what is left";
  }
}

TEST(Loudness, FingersThatDoNotFitTogetherAreLoweredAlike) {
  const Layout layout = posed("openmpd");
  Schedule schedule;
  for (const double x : {-0.015, 0.015})
    add_ring(schedule, {x, 0, 0}, 5e-3, 4e3);
  const Heard heard = solved(layout, schedule);
  EXPECT_LT(heard.least[0], 3.5e3);
  EXPECT_GT(heard.peak, 0.97);
  for (const int voice : {0, 1}) {
    EXPECT_NEAR(heard.least[voice] / heard.least[0], 1, 5e-3);
    EXPECT_NEAR(heard.most[voice] / heard.least[voice], 1, 5e-3);
  }
}

TEST(Loudness, FociThatSoundTogetherEachHaveItOfTheWholeSound) {
  const Layout layout = posed("paper");
  Schedule schedule;
  sound_together(add_ring(schedule, {-0.015, 0, 0}, 5e-3, 3e3));
  sound_together(add_ring(schedule, {0.015, 0, 0}, 5e-3, 2e3, 7));
  const Heard heard = solved(layout, schedule, {.solver = Solver::gs_pat});
  expect_pressure(heard, 0, 3e3);
  expect_pressure(heard, 1, 2e3);
}

TEST(Loudness, AModulationHasItsCrestThereAndDisturbsNobody) {
  const Layout layout = posed("paper");
  Schedule schedule;
  add_ring(schedule, {-0.015, 0, 0}, 5e-3, 8e3);
  Voice& still = add_ring(schedule, {0.015, 0, 0}, 0, 8e3, 1);
  still.modulation_hz = 200;
  still.gain = 0.5;
  Loudness loudness(layout, {});
  loudness.solve(schedule, 10);
  EXPECT_NEAR(*schedule.voices[1].reached_pa, 4e3, 8);
  for (std::uint32_t number = 0; number < 10; ++number) {
    const auto [foci, drive] = slot_of(layout, schedule, number, loudness);
    EXPECT_NEAR(pressure(layout, drive, foci[0]), 8e3, 16) << number;
    const double part = modulation_gain(Modulation::pressure_sine, 200, (number + 0.5) * 1.5e-3);
    EXPECT_NEAR(pressure(layout, drive, foci[1]), 4e3 * std::max(part, 0.01), 8) << number;
  }
}

/// Fingers of one focus, a centimetre apart. Every second one asks for almost nothing of its possible pressure.
Schedule crowd_of_points(std::uint32_t fingers) {
  Schedule schedule;
  for (std::uint32_t f = 0; f < fingers; ++f)
    add_ring(schedule, {0.01 * (f % 20) - 0.08, 0, 0.01 * (f / 20)}, 0, f % 2 == 0 ? 100 : 0, 1);
  return schedule;
}

TEST(Loudness, AFingerThatAsksForLittleHasItBesideManyThatAskForNothing) {
  const Layout layout = posed("paper");
  for (const std::uint32_t fingers : {4u, 24u, 64u}) {
    Schedule schedule = crowd_of_points(fingers);
    const Heard heard = solved(layout, schedule);
    for (std::uint32_t f = 0; f < fingers; ++f) {
      if (f % 2 == 0) {
        expect_pressure(heard, f, 100);
      } else {
        EXPECT_GT(heard.least[f], 900) << f << " of " << fingers;
      }
    }
    EXPECT_GT(heard.peak, 0.95) << "all that is left";
    // The same for a slot that is not listed.
    std::vector<SlotFocus> foci;
    foci_of_slot(schedule, 0, foci);
    const Drive drive = drive_for(layout, foci);
    for (std::uint32_t f = 0; f < fingers; f += 2)
      EXPECT_NEAR(pressure(layout, drive, foci[f]), 100, 2) << f;
  }
}

TEST(Loudness, SilentFingersAndPlacesThatCannotBeDrivenDoNoHarm) {
  const Layout layout = posed("openmpd");
  Schedule schedule;
  add_ring(schedule, {0, 0, 0}, 5e-3, 1e3);
  add_ring(schedule, {0.03, 0, 0}, 5e-3, 1e3).gain = 0;
  add_ring(schedule, {200, 0, 0}, 5e-3, 1e3);
  const Heard heard = solved(layout, schedule);
  expect_pressure(heard, 0, 1e3);
  EXPECT_EQ(*schedule.voices[1].reached_pa, 0);
  EXPECT_EQ(*schedule.voices[2].reached_pa, 0);
}

TEST(Loudness, FingersAtOnePlaceHaveTheLouderPressure) {
  const Layout layout = posed("paper");
  Schedule schedule;
  for (int f = 0; f < 2; ++f)
    add_ring(schedule, {0, 0, 0}, 5e-3, f == 0 ? 8e3 : 3e3);
  const Heard heard = solved(layout, schedule);
  for (const int voice : {0, 1})
    expect_pressure(heard, voice, 8e3);
  EXPECT_LT(heard.peak, 0.3) << "not twice what one needs";
}

/// Seven fingers of ten foci, all at the same time. Every second one asks, or all of them.
Schedule crowd(bool all_ask) {
  Schedule schedule;
  for (int f = 0; f < 7; ++f)
    sound_together(
        add_ring(schedule, {0.03 * (f % 4) - 0.045, 0, 0.03 * (f / 4)}, 5e-3, all_ask || f % 2 == 0 ? 1e3 : 0));
  return schedule;
}

TEST(Loudness, MoreFociThanAreSolvedTogetherAreNeverLouderThanAsked) {
  const Layout layout = posed("openmpd");
  for (const bool all_ask : {true, false}) {
    Schedule schedule = crowd(all_ask);
    const Heard heard = solved(layout, schedule, {}, 1);
    for (int f = 0; f < 7; ++f) {
      EXPECT_NEAR(heard.least[f], *schedule.voices[f].reached_pa, 1e-3 * heard.least[f]) << f;
      if (!all_ask && f % 2 != 0) continue;
      EXPECT_LE(heard.most[f], 1e3 * 1.001) << f;
      EXPECT_GT(heard.most[f], 200) << f;
    }
    // The same for a slot that is not listed.
    std::vector<SlotFocus> foci;
    foci_of_slot(schedule, 0, foci);
    ASSERT_EQ(foci.size(), 70u);
    const Drive drive = drive_for(layout, foci);
    for (const SlotFocus& focus : foci)
      EXPECT_LE(pressure(layout, drive, focus), focus.most_pa.value_or(1e9) * 1.001) << focus.voice;
  }
}

TEST(Loudness, AFingerThatAsksForNothingDoesNotRaiseItsNeighbour) {
  const Layout layout = posed("openmpd");
  for (const double beside : {0.0, 0.5e-3, 1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3, 5e-3, 7e-3, 10e-3}) {
    Schedule schedule;
    add_ring(schedule, {0, 0, 0}, 0, 500, 1);
    add_ring(schedule, {beside, 0, 0}, 0, 0, 1);
    const Heard heard = solved(layout, schedule);
    expect_pressure(heard, 0, 500, 5e-3);
    EXPECT_GT(heard.least[1], 495) << beside;
  }
}

TEST(Loudness, ATinyGainChangesNoOtherFinger) {
  const Layout layout = posed("openmpd");
  for (const double gain : {1e-320, 1e-300, 1e-20}) {
    Schedule schedule;
    add_ring(schedule, {-0.015, 0, 0}, 5e-3, 1e3).gain = gain;
    add_ring(schedule, {0.015, 0, 0}, 5e-3, 1e3);
    const Heard heard = solved(layout, schedule);
    expect_pressure(heard, 1, 1e3);
    EXPECT_TRUE(std::isfinite(heard.peak) && std::isfinite(*schedule.voices[0].reached_pa)) << gain;
  }
}

TEST(Loudness, OneFocusBesideOneThatCannotBeDrivenHasAllOfItsFactor) {
  const Layout layout = posed("openmpd");
  const std::vector<SlotFocus> foci{{Vec3(0)}, {Vec3(200, 0, 0)}};
  const std::vector<std::complex<double>> factors{std::complex<double>(0, 0.3), 0};
  Drive drive(layout.transducers.size());
  DriveScratch scratch;
  drive_by_factors(layout, foci, factors, {}, drive, scratch);
  const Drive alone = drive_for(layout, std::span(foci).first(1));
  for (std::size_t n = 0; n < drive.size(); ++n)
    ASSERT_NEAR(drive[n].amplitude, 0.3 * alone[n].amplitude, 1e-6);
  DriveMemory memory(test::test_device(), layout, {}, 1, 2);
  const DrivePasses passes(test::test_device(), Solver::naive);
  ASSERT_TRUE(memory.add_slot(foci, factors));
  test::run_on_device([&](VkCommandBuffer commands) { memory.record(commands, passes); });
  memory.solve_on_host();
  for (std::size_t n = 0; n < drive.size(); ++n)
    ASSERT_NEAR(memory.drive(0)[n].amplitude, drive[n].amplitude, 1e-5);
}

TEST(Loudness, AmplitudesAreAtMostOneAndReportedPressuresAreReached) {
  const Layout layout = posed("openmpd");
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.04, 0.04), power(2, 5);
  for (int trial = 0; trial < 30; ++trial) {
    Schedule schedule;
    const auto fingers = 2 + random() % 5;
    for (unsigned f = 0; f < fingers; ++f) {
      Voice& voice =
          add_ring(schedule, {place(random), place(random), place(random)}, 5e-3, std::pow(10, power(random)));
      if (random() % 4 == 0) sound_together(voice);
    }
    const DriveOptions options{.solver = trial % 2 == 0 ? Solver::naive : Solver::gs_pat};
    const Heard heard = solved(layout, schedule, options);
    for (unsigned f = 0; f < fingers; ++f) {
      const double reached = *schedule.voices[f].reached_pa;
      EXPECT_TRUE(std::isfinite(reached)) << trial;
      EXPECT_NEAR(heard.least[f], reached, 2e-3 * reached + 0.5) << trial << " finger " << f;
    }
  }
}

TEST(Loudness, AFrameDoesNotDependOnThoseBefore) {
  const Layout layout = posed("openmpd");
  Loudness used(layout, {});
  struct Ring {
    Vec3 centre;
    double pressure_pa;
    std::uint32_t foci;
  };
  // Fingers that move, come and go, have other foci and ask for nothing.
  const std::vector<Ring> frames[]{{{{-0.02, 0, 0}, 2e3, 10}, {{0.02, 0, 0}, 0, 6}},
                                   {{{-0.02, 0, 0.02}, 2e3, 10}, {{0.02, 0, -0.02}, 0, 6}},
                                   {{{0.03, 0.02, 0}, 3e3, 6}},
                                   {{{0, 0, 0}, 0, 6}, {{0.03, 0, 0}, 1e3, 6}, {{-0.03, 0, 0}, 3e3, 6}}};
  for (const std::vector<Ring>& frame : frames) {
    Schedule schedule;
    for (const Ring& ring : frame)
      add_ring(schedule, ring.centre, 5e-3, ring.pressure_pa, ring.foci);
    Schedule again = schedule;
    Loudness fresh(layout, {});
    used.solve(schedule, 6);
    fresh.solve(again, 6);
    for (std::uint32_t slot = 0; slot < 6; ++slot)
      EXPECT_TRUE(std::ranges::equal(used.factors(slot), fresh.factors(slot))) << slot;
    for (std::uint32_t v = 0; v < schedule.voice_count; ++v)
      EXPECT_EQ(schedule.voices[v].reached_pa, again.voices[v].reached_pa) << v;
  }
}

TEST(Loudness, TheDeviceAddsUpTheSameDrives) {
  const Layout layout = posed("paper");
  const DriveOptions options{.solver = Solver::gs_pat};
  Schedule schedule;
  sound_together(add_ring(schedule, {-0.015, 0, 0}, 5e-3, 3e3));
  add_ring(schedule, {0.015, 0, 0}, 5e-3, 3e3);
  add_ring(schedule, {0.045, 0, 0}, 5e-3, 60e3);
  Schedule single;
  add_ring(single, {0, 0, 0}, 5e-3, 3e3);
  for (Schedule* each : {&schedule, &single}) {
    Loudness loudness(layout, options);
    loudness.solve(*each, 10);
    gpu::Device& device = test::test_device();
    const DrivePasses passes(device, Solver::naive);  // factors come from the host
    DriveMemory memory(device, layout, options, 10, 200);
    std::vector<SlotFocus> foci;
    for (int times = 0; times < 2; ++times) {  // the second one uses the memory as the first left it
      memory.clear();
      for (std::uint32_t slot = 0; slot < 10; ++slot) {
        foci_of_slot(*each, slot, foci);
        ASSERT_TRUE(memory.add_slot(foci, loudness.factors(slot)));
      }
      test::run_on_device([&](VkCommandBuffer commands) { memory.record(commands, passes); });
      memory.solve_on_host();
    }
    for (std::uint32_t slot = 0; slot < 10; ++slot) {
      const Drive drive = slot_of(layout, *each, slot, loudness, options).drive;
      for (std::size_t n = 0; n < drive.size(); ++n) {
        const TransducerDrive &a = drive[n], &b = memory.drive(slot)[n];
        const auto as_complex = [](const TransducerDrive& t) {
          return std::polar(static_cast<double>(t.amplitude), static_cast<double>(t.phase));
        };
        ASSERT_NEAR(std::abs(as_complex(a) - as_complex(b)), 0, 2e-5) << slot << " " << n;
      }
    }
  }
}

}  // namespace
}  // namespace palpa::array
