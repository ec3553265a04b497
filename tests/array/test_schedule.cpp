// The schedule: orders, dwell across frames, modulation, cycles.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "array/schedule.hpp"
#include "base/error.hpp"
#include "geometry/haptics.hpp"
#include "support/thrown.hpp"

namespace palpa::array {
namespace {

/// A voice of `count` foci, the n-th at x = n, in the paper's order.
Voice voice_of(std::uint32_t count) {
  Voice voice;
  for (std::uint32_t n = 0; n < count; ++n)
    voice.foci.emplace_back(n, 0, 0);
  fill_order(count, 3, voice.order);
  return voice;
}

Schedule schedule_of(const Voice& voice) {
  Schedule schedule;
  schedule.add_voice() = voice;
  return schedule;
}

std::vector<SlotFocus> foci_at(const Schedule& schedule, std::uint64_t slot) {
  std::vector<SlotFocus> foci;
  foci_of_slot(schedule, slot, foci);
  return foci;
}

TEST(FillOrder, IsThePapers) {
  EXPECT_EQ(fill_order(10, 3), (std::vector<std::uint32_t>{0, 3, 6, 9, 2, 5, 8, 1, 4, 7}));
  EXPECT_EQ(fill_order(1, 3), std::vector<std::uint32_t>{0});
  EXPECT_EQ(fill_order(1, 0), std::vector<std::uint32_t>{0});
  EXPECT_EQ(fill_order(4, 7), (std::vector<std::uint32_t>{0, 3, 2, 1}));
}

TEST(FillOrder, EveryFocusOnceOrRefused) {
  EXPECT_TRUE(rc::check([] {
    const auto count = *rc::gen::inRange<std::uint32_t>(1, 300);
    const auto stride = *rc::gen::inRange<std::uint32_t>(0, 1000);
    if (std::gcd(count, stride) != 1) {
      const Error error = test::thrown_by([&] { fill_order(count, stride); });
      RC_ASSERT(error.code() == Exit::usage);
      const std::string both = "stride " + std::to_string(stride) + " and " + std::to_string(count) + " foci";
      RC_ASSERT(std::string(error.what()).find(both) != std::string::npos);
      return;
    }
    const auto order = fill_order(count, stride);
    const std::set<std::uint32_t> unique(order.begin(), order.end());
    RC_ASSERT(order.size() == count && unique.size() == count && *unique.rbegin() == count - 1);
    for (std::size_t i = 1; i < order.size(); ++i)
      RC_ASSERT((order[i - 1] + stride) % count == order[i]);
  }));
}

TEST(FillOrder, TheDefaultStrideIsTheNearestToThreeTenthsThatLeavesNoneOut) {
  EXPECT_EQ(geometry::default_stride(10), 3U) << "the paper's";
  EXPECT_EQ(geometry::default_stride(5), 2U) << "1 is as near: the larger";
  EXPECT_EQ(geometry::default_stride(1), 1U);
  for (std::uint32_t foci = 2; foci <= 64; ++foci) {
    std::uint32_t nearest = 0;
    for (std::uint32_t stride = 1; stride < foci; ++stride) {
      if (std::gcd(stride, foci) != 1) continue;
      if (nearest == 0 || std::abs(stride - 0.3 * foci) <= std::abs(nearest - 0.3 * foci) + 1e-9) nearest = stride;
    }
    EXPECT_EQ(geometry::default_stride(foci), nearest) << foci;
  }
}

TEST(FillOrder, SaysWhichStrideWouldDo) {
  EXPECT_ERROR(fill_order(10, 4), Exit::usage, "such as 3");
  EXPECT_ERROR(fill_order(0, 1), Exit::usage, "0 foci");
}

TEST(Schedule, FociThatAdvanceAreWhereTheirVelocityTakesThem) {
  Schedule schedule = schedule_of(voice_of(10));
  schedule.voices[0].velocity = {0, 2, 0};
  EXPECT_EQ(foci_at(schedule, 3)[0].position.y, 0) << "without times they stand";
  EXPECT_EQ(schedule.advance.time_of(3, schedule.slot_s), 0);
  for (const std::uint32_t cycles : {2U, 5U}) {
    schedule.advance = {.first_slot = 24, .cycle = 10, .cycles = cycles, .first_s = -0.003, .most_s = 0.02};
    for (std::uint64_t slot = 0; slot < 120; ++slot) {
      const std::uint32_t number = schedule.advance.number_of(slot);
      ASSERT_LT(number, schedule.advance.listed());
      EXPECT_EQ((number + 24) % 10, slot % 10) << "the same place in the cycle";
      if (slot >= 24 && slot < 24 + 10 * cycles) {
        EXPECT_EQ(number, slot - 24);
      }
      const std::vector<SlotFocus> foci = foci_at(schedule, slot);
      EXPECT_NEAR(foci[0].position.y, 2 * std::min(-0.003 + number * schedule.slot_s, 0.02), 1e-12);
      EXPECT_EQ(foci[0].position.x, fill_order(10, 3)[slot % 10]);
    }
  }
}

TEST(Schedule, TogetherPlaysAllInEverySlot) {
  Voice voice = voice_of(10);
  fill_order(10, 1, voice.order);
  voice.foci_per_slot = 10;
  const Schedule schedule = schedule_of(voice);
  for (const std::uint64_t slot : {0u, 1u, 17u}) {
    const std::vector<SlotFocus> foci = foci_at(schedule, slot);
    ASSERT_EQ(foci.size(), 10u);
    for (int n = 0; n < 10; ++n)
      EXPECT_EQ(foci[n].position.x, n);
  }
  EXPECT_EQ(cycle_length(schedule, 100), 1u);
}

TEST(Schedule, AVoicesOwnDwell) {
  Voice voice = voice_of(10);
  voice.dwell_s = 4e-3;
  const Schedule schedule = schedule_of(voice);      // ticks of 1.5 ms
  for (std::uint64_t slot = 0; slot < 1000; ++slot)  // 1.5 / 4 = 3 / 8
    EXPECT_EQ(foci_at(schedule, slot)[0].position.x, voice.order[slot * 3 / 8 % 10]) << slot;
}

TEST(Schedule, NoRoundingMakesAStepLate) {
  // 3 dwells of 0.1 ms are 0.3 ms, but not in floating point.
  Voice voice = voice_of(7);
  for (const double dwell : {1e-4, 1.1e-4, 7e-4, 1.5e-3, 0.3}) {
    for (const int ratio : {1, 3, 6, 7}) {
      voice.dwell_s = dwell * ratio;
      Schedule schedule = schedule_of(voice);
      schedule.slot_s = dwell;
      for (const std::uint64_t begin : {std::uint64_t{0}, std::uint64_t{1} << 32}) {
        for (std::uint64_t slot = begin; slot < begin + 100; ++slot)
          ASSERT_EQ(foci_at(schedule, slot)[0].position.x, voice.order[slot / ratio % 7])
              << dwell << " " << ratio << " " << slot;
      }
    }
  }
}

TEST(Schedule, HasNoFociWithoutVoices) {
  Schedule schedule;
  std::vector<SlotFocus> foci{{}};
  foci_of_slot(schedule, 3, foci);
  EXPECT_TRUE(foci.empty());
  schedule.add_voice() = voice_of(1);
  foci_of_slot(schedule, 3, foci);
  EXPECT_EQ(foci.size(), 1u);
  schedule.clear();
  foci_of_slot(schedule, 3, foci);
  EXPECT_TRUE(foci.empty());
}

TEST(Modulation, OfTheAmplitudeIsASineOfThePressureItsSquareRoot) {
  constexpr auto amplitude = Modulation::amplitude_sine, pressure = Modulation::pressure_sine;
  EXPECT_EQ(modulation_gain(amplitude, 0, 12.3), 1);
  EXPECT_EQ(modulation_gain(pressure, 0, 12.3), 1);
  EXPECT_NEAR(modulation_gain(amplitude, 200, 1000.00125), 1, 1e-9);
  for (double t = 0; t < 0.02; t += 1.7e-4) {
    const double sine = 0.5 + 0.5 * std::sin(400 * std::numbers::pi * t), gain = modulation_gain(pressure, 200, t);
    EXPECT_NEAR(modulation_gain(amplitude, 200, t), sine, 1e-12) << t;
    EXPECT_NEAR(gain * gain, sine, 1e-12) << t;
  }
}

TEST(Modulation, GainsAreSampledAtSlotMidpoints) {
  Voice voice = voice_of(1);
  voice.modulation_hz = 200;
  voice.modulation = Modulation::amplitude_sine;
  const Schedule schedule = schedule_of(voice);
  double mean = 0;
  for (std::uint64_t slot = 0; slot < 10; ++slot) {
    const float gain = foci_at(schedule, slot)[0].gain;
    const double t = (static_cast<double>(slot) + 0.5) * 1.5e-3;
    EXPECT_NEAR(gain, 0.5 + 0.5 * std::sin(400 * std::numbers::pi * t), 1e-6);
    mean += gain / 10;
  }
  // 3 whole periods.
  EXPECT_NEAR(mean, 0.5, 1e-6);
}

TEST(Modulation, SharedWhereAllVoicesHaveTheSame) {
  Schedule schedule;
  EXPECT_TRUE(shared_modulation(schedule));
  for (int i = 0; i < 3; ++i)
    schedule.add_voice().modulation_hz = 200;
  EXPECT_TRUE(shared_modulation(schedule));
  schedule.voices[2].modulation_hz = 0;
  EXPECT_FALSE(shared_modulation(schedule));
  schedule.voice_count = 2;
  EXPECT_TRUE(shared_modulation(schedule));
  schedule.voices[1].modulation = Modulation::amplitude_sine;
  EXPECT_FALSE(shared_modulation(schedule));
}

TEST(Cycle, LengthsByHand) {
  EXPECT_EQ(cycle_length(Schedule{}, 10), 1u);
  EXPECT_EQ(cycle_length(Schedule{}, 0), 0u);
  Schedule schedule;
  schedule.add_voice() = voice_of(10);
  EXPECT_EQ(cycle_length(schedule, 10), 10u);
  EXPECT_EQ(cycle_length(schedule, 9), 0u);
  schedule.add_voice() = voice_of(7);
  EXPECT_EQ(cycle_length(schedule, 70), 70u);
  EXPECT_EQ(cycle_length(schedule, 69), 0u);
  // 200 Hz is 0.3 turns a slot: 10 slots.
  schedule.voices[1].modulation_hz = 200;
  EXPECT_EQ(cycle_length(schedule, 1000), 70u);
  schedule.voices[1].modulation_hz = 130;  // 0.195 turns: 200 slots
  EXPECT_EQ(cycle_length(schedule, 10000), 1400u);
  schedule.voices[1].modulation_hz = 1e-3;
  EXPECT_EQ(cycle_length(schedule, 1u << 20), 0u);
}

TEST(Cycle, IsTheShortestTimeAfterWhichFociAndGainsRepeat) {
  EXPECT_TRUE(rc::check([] {
    Schedule schedule;
    schedule.slot_s = *rc::gen::element(1e-3, 1.5e-3, 2e-3, 0.1e-3);
    const auto voices = *rc::gen::inRange(1, 4);
    for (int v = 0; v < voices; ++v) {
      Voice& voice = schedule.add_voice();
      voice = voice_of(*rc::gen::element<std::uint32_t>(1, 5, 7, 10));
      voice.dwell_s = schedule.slot_s * *rc::gen::element(1.0, 1.5, 2.0, 3.0);
      voice.modulation_hz = *rc::gen::element(0.0, 100.0, 200.0, 250.0);
    }
    const std::uint64_t cycle = cycle_length(schedule, 100000);
    RC_ASSERT(cycle > 0);
    const auto repeats_after = [&](std::uint64_t length) {
      for (std::uint64_t slot = 0; slot < cycle; ++slot) {
        const std::vector<SlotFocus> a = foci_at(schedule, slot), b = foci_at(schedule, slot + length);
        for (std::size_t i = 0; i < a.size(); ++i) {
          if (a[i].position != b[i].position || std::abs(a[i].gain - b[i].gain) > 1e-5F) return false;
        }
      }
      return true;
    };
    RC_ASSERT(repeats_after(cycle));
    for (const std::uint64_t divisor : {2u, 3u, 5u, 7u}) {
      if (cycle % divisor == 0) RC_ASSERT(!repeats_after(cycle / divisor));
    }
  }));
}

}  // namespace
}  // namespace palpa::array
