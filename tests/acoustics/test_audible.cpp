// How loud drives are to the ear, against numbers of an independent program and against what is known of one
// transducer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "acoustics/audible.hpp"
#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {
namespace {

constexpr double pi = std::numbers::pi;

EarOptions ear() {
  EarOptions options;
  options.air = air_of({});
  return options;
}

/// Ten foci on a ring of 35 mm, 150 mm above `openmpd`, every third one after the other.
std::vector<array::TransducerDrive> ring_drives() {
  const array::Layout layout = array::load_layout("openmpd");
  std::vector<array::TransducerDrive> drives;
  for (int slot = 0; slot < 10; ++slot) {
    const double angle = 2 * pi * (3 * slot % 10) / 10;
    const array::SlotFocus foci[]{{{0.0175 * std::cos(angle), 0.0175 * std::sin(angle), 0.15}}};
    const array::Drive drive = array::drive_for(layout, foci, {});
    drives.insert(drives.end(), drive.begin(), drive.end());
  }
  return drives;
}

/// One focus, modulated at 200 Hz, in slots of that length, for 15 ms.
std::vector<array::TransducerDrive> still_drives(double slot_s) {
  const array::Layout layout = array::load_layout("openmpd");
  const array::SlotFocus foci[]{{{0, 0, 0.15}}};
  const array::Drive drive = array::drive_for(layout, foci, {});
  std::vector<array::TransducerDrive> drives;
  for (double t = slot_s / 2; t < 15e-3; t += slot_s) {
    for (array::TransducerDrive one : drive) {
      one.amplitude *= static_cast<float>(std::sqrt(0.5 * (1 + std::sin(2 * pi * 200 * t))));
      drives.push_back(one);
    }
  }
  return drives;
}

double level_of(const std::vector<array::TransducerDrive>& drives, double slot_s, const array::Changes& changes,
                double q) {
  return a_weighted_db(heard_sound({drives, 256, slot_s, changes}, q, ear()));
}

TEST(Audible, IsAsAnIndependentProgramComputesIt) {
  const auto drives = ring_drives();
  struct Case {
    array::Changes changes;
    double q20, q40;
  };
  for (const Case& one : {Case{{}, 63.72, 60.45}, Case{{4, 7, 7}, 46.78, 49.00}, Case{{4, 14, 14}, 36.60, 37.88},
                          Case{{1, 40, 10}, 39.12, 43.83}, Case{{1, 60, 10}, 27.41, 32.73}}) {
    EXPECT_NEAR(level_of(drives, 1.5e-3, one.changes, 20), one.q20, 0.2) << one.changes.phase_steps;
    EXPECT_NEAR(level_of(drives, 1.5e-3, one.changes, 40), one.q40, 0.2) << one.changes.phase_steps;
  }
  EXPECT_NEAR(level_of(still_drives(1.5e-3), 1.5e-3, {}, 20), 57.49, 0.1);
  EXPECT_NEAR(level_of(still_drives(1.5e-3), 1.5e-3, {}, 40), 53.29, 0.1);
  EXPECT_NEAR(level_of(still_drives(0.3e-3), 0.3e-3, {4, 2, 2}, 20), 44.92, 0.1);
  EXPECT_NEAR(level_of(still_drives(0.3e-3), 0.3e-3, {4, 2, 2}, 40), 42.54, 0.1);
  EXPECT_NEAR(level_of(still_drives(0.25e-3), 0.25e-3, {1, 10, 10}, 20), 41.60, 0.1);
  const EarLevel range = ear_level({drives, 256, 1.5e-3, {}}, ear());
  EXPECT_NEAR(range.low_dba, 60.45, 0.1);
  EXPECT_NEAR(range.high_dba, 63.72, 0.1);
  EXPECT_EQ(to_text(range), "60 to 64 dB(A)");
}

TEST(Audible, ThePowerDipsAndReturnsAfterAJumpAsAResonatorDoes) {
  // P / P0 = 1 - 4 (e - e^2) after a jump by half a turn, e = exp(-t / tau), tau = Q / (pi f).
  const std::vector<array::TransducerDrive> drives{{1, 0}, {1, static_cast<float>(pi)}};
  const double q = 30, tau_s = q / (pi * 40e3);
  const std::vector<double> power = radiated_power({drives, 1, 5e-3, {}}, q, ear());
  ASSERT_EQ(power.size(), 400u);
  const double whole = 4.386 * 4.386 * pi * 0.291 / (ear().air.density_kg_m3 * ear().air.medium.sound_speed);
  for (std::size_t k = 0; k < 200; ++k) {
    const double e = std::exp(-25e-6 * static_cast<double>(k + 1) / tau_s);
    EXPECT_NEAR(power[k] / whole, 1 - 4 * (e - e * e), 1e-6) << k;
  }
}

/// One short drive that repeats is a sound that never changes.
TEST(Audible, AStillFocusWithoutAModulationIsSilent) {
  const std::vector<array::TransducerDrive> still{{1, 0.5}, {0.7f, 2}};
  for (const double slot_s : {0.3e-3, 1.5e-3}) {
    EXPECT_EQ(to_text(ear_level({still, 2, slot_s, {}}, ear())), "less than 0 dB(A)") << slot_s;
  }
}

TEST(Audible, FollowsTheSquareOfAmplitudesAndTheDistance) {
  auto drives = ring_drives();
  EarOptions far = ear();
  far.distance_m *= 2;
  const double before = a_weighted_db(heard_sound({drives, 256, 1.5e-3, {}}, 20, ear()));
  EXPECT_NEAR(a_weighted_db(heard_sound({drives, 256, 1.5e-3, {}}, 20, far)), before - 20 * std::log10(2.0), 1e-9);
  for (array::TransducerDrive& one : drives)
    one.amplitude *= 0.04f;
  EXPECT_NEAR(a_weighted_db(heard_sound({drives, 256, 1.5e-3, {}}, 20, ear())), before + 40 * std::log10(0.04), 1e-3);
  EXPECT_EQ(to_text(ear_level({drives, 256, 1.5e-3, {4, 14, 14}}, ear())), "less than 0 dB(A)");
}

TEST(Audible, ConstantPowerIsSilentAndTheWeightingIsThatOfTheStandard) {
  const std::vector<array::TransducerDrive> still{{0.5f, 1}, {0.5f, 1}, {0.5f, 1}};
  EXPECT_LT(a_weighted_db(heard_sound({still, 1, 1.5e-3, {}}, 20, ear())), -100);
  // IEC 61672-1, table 3.
  for (const auto& [hz, db] : {std::pair(100.0, -19.1), {200.0, -10.9}, {1000.0, 0.0}, {2500.0, 1.3}, {10000.0, -2.5}})
    EXPECT_NEAR(a_weighting_db(hz), db, 0.1) << hz;
}

/// Nothing changes in the rest of a long slot: its energy is spread over a longer time.
TEST(Audible, LongSlotsAreQuieterByTheirLength) {
  const std::vector<array::TransducerDrive> drives{{1, 0}, {1, static_cast<float>(pi)}, {0.5f, 0}};
  const auto level_in = [&](double slot_s, const array::Changes& changes) {
    return a_weighted_db(heard_sound({drives, 1, slot_s, changes}, 40, ear()));
  };
  for (const array::Changes& changes : {array::Changes{}, array::Changes{4, 14, 14}}) {
    for (const double slot_s : {20e-3, 50e-3, 60e-3, 1.0})
      EXPECT_NEAR(level_in(slot_s, changes), level_in(10e-3, changes) - 10 * std::log10(slot_s / 10e-3), 0.02)
          << slot_s;
  }
  // A slot that is heard as a whole.
  EXPECT_NEAR(level_in(10e-3, {}), level_in(8e-3, {}) - 10 * std::log10(10.0 / 8), 0.1);
}

TEST(Audible, AWavFileOfLongSlotsHasTheirPauses) {
  const std::vector<array::TransducerDrive> drives{{1, 0}, {1, static_cast<float>(pi)}, {0.5f, 0}};
  double peak = 0;
  const std::string wav = to_wav(heard_sound({drives, 1, 60e-3, {}}, 20, ear()), 30, peak);
  const auto loudest = [&](double from_s, double to_s) {
    int most = 0;
    for (auto i = static_cast<std::size_t>(from_s * 48000); i < static_cast<std::size_t>(to_s * 48000); ++i) {
      std::int16_t value = 0;
      std::memcpy(&value, wav.data() + 44 + 2 * i, 2);
      most = std::max(most, std::abs(value));
    }
    return most;
  };
  for (const int slot : {0, 1, 2, 3, 4, 40}) {
    EXPECT_GT(loudest(60e-3 * slot, 60e-3 * slot + 5e-3), 100) << slot;
    EXPECT_EQ(loudest(60e-3 * slot + 11e-3, 60e-3 * slot + 59e-3), 0) << slot;
  }
}

TEST(Audible, AWavFileHasTheSoundAtItsScale) {
  // Power that is modulated by a sine of 1 kHz, so that the sound is one, too.
  HeardSound tone{15e-3, std::vector<std::complex<double>>(300)};
  const double pascals = 20e-6 * std::sqrt(2.0) * std::pow(10.0, 75.0 / 20);  // the peak of 75 dB
  tone.lines[14] = 0.5 * pascals;                                             // the 15th of 66.7 Hz
  tone.lines[270] = pascals;                                                  // 18 kHz, which is left out
  EXPECT_NEAR(a_weighted_db(tone),
              10 * std::log10(std::pow(10, 7.5) + 4 * std::pow(10, 7.5 + a_weighting_db(18066.7) / 10)), 0.05);
  double peak = 0;
  const std::string wav = to_wav(tone, 81, peak);
  EXPECT_NEAR(peak, std::pow(10.0, -6.0 / 20), 1e-3);
  ASSERT_EQ(wav.size(), 44u + 3 * 48000 * 2);
  EXPECT_EQ(wav.substr(0, 4) + wav.substr(8, 8), "RIFFWAVEfmt ");
  const auto sample = [&](std::size_t i) {
    std::int16_t value = 0;
    std::memcpy(&value, wav.data() + 44 + 2 * i, 2);
    return value / 32767.0;
  };
  for (const std::size_t i : {0UL, 5UL, 12UL, 719UL, 720UL, 100000UL, 143999UL})
    EXPECT_NEAR(sample(i), peak * std::cos(2 * pi * 1000 * static_cast<double>(i) / 48000), 1e-3) << i;
  to_wav(tone, 70, peak);
  EXPECT_GT(peak, 1) << "it says that samples are cut";
}

}  // namespace
}  // namespace palpa::acoustics
