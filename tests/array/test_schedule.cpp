// The schedule: orders, dwell across frames, voices from fingers, modulation, cycles.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "array/schedule.hpp"
#include "base/error.hpp"
#include "touch/method.hpp"

namespace palpa::array {
namespace {

/// A finger whose sector n lies at x = n; sectors with 0 points are at NaN, as nobody may look there.
touch::Finger finger_with(const std::vector<std::uint32_t>& points) {
  touch::Finger finger;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const float x = points[n] ? static_cast<float>(n) : std::nanf("");
    finger.foci.push_back({{x, 0, 0}, points[n]});
  }
  finger.section.centroid = {-1, 0, 0};
  return finger;
}

touch::Placement placed(const touch::Finger& finger, touch::Method method = touch::Method::cross_section) {
  touch::Placement placement;
  touch::place_foci({}, finger, {.method = method}, placement);
  return placement;
}

Voice voice_of(const touch::Finger& finger, const VoiceOptions& options = {},
               touch::Method method = touch::Method::cross_section) {
  Voice voice;
  make_voice(placed(finger, method), 7, 5, options, voice);
  return voice;
}

std::vector<double> places(const Voice& voice) {
  std::vector<double> xs;
  for (const Vec3& focus : voice.foci)
    xs.push_back(focus.x);
  return xs;
}

Schedule schedule_of(const Voice& voice) {
  Schedule schedule;
  schedule.add_voice() = voice;
  return schedule;
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
      RC_ASSERT_THROWS_AS(fill_order(count, stride), Error);
      return;
    }
    const auto order = fill_order(count, stride);
    const std::set<std::uint32_t> unique(order.begin(), order.end());
    RC_ASSERT(order.size() == count && unique.size() == count && *unique.rbegin() == count - 1);
    for (std::size_t i = 1; i < order.size(); ++i)
      RC_ASSERT((order[i - 1] + stride) % count == order[i]);
  }));
}

TEST(FillOrder, SaysWhichStrideWouldDo) {
  try {
    fill_order(10, 4);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::usage);
    EXPECT_NE(std::string(error.what()).find("such as 3"), std::string::npos) << error.what();
  }
  EXPECT_THROW(fill_order(0, 1), Error);
}

TEST(Voice, KeepsAFingersFoci) {
  const Voice voice = voice_of(finger_with({5, 5, 5, 5, 5, 5, 5, 5, 5, 5}));
  EXPECT_EQ(places(voice), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(voice.order, fill_order(10, 3));
  EXPECT_EQ(voice.id, 7u);
  EXPECT_EQ(voice.solid, 5u);
  EXPECT_EQ(voice.modulation_hz, 0);
  EXPECT_EQ(voice.foci_per_slot, 1u);
  EXPECT_EQ(voice.dwell_s, 1.5e-3);
}

TEST(Voice, AnEmptySectorPlaysTheNearestOtherByAngle) {
  // 3 is as near to 2 as to 4: the lower index. 0 is nearest to 9, the long way round in index.
  EXPECT_EQ(places(voice_of(finger_with({0, 0, 1, 0, 1, 1, 1, 1, 1, 1}))),
            (std::vector<double>{9, 2, 2, 2, 4, 5, 6, 7, 8, 9}));
  // 0 lies between 1 and 9.
  EXPECT_EQ(places(voice_of(finger_with({0, 1, 1, 1, 1, 1, 1, 1, 1, 1})))[0], 1);
  // 9 lies between 8 and 0: the lower index is 0.
  EXPECT_EQ(places(voice_of(finger_with({1, 1, 1, 1, 1, 1, 1, 1, 1, 0})))[9], 0);
  EXPECT_EQ(places(voice_of(finger_with({0, 0, 0, 0, 0, 0, 2, 0, 0, 0}))), std::vector<double>(10, 6.0));
}

TEST(Voice, NearestOtherAgreesWithAngles) {
  EXPECT_TRUE(rc::check([] {
    const auto points =
        *rc::gen::suchThat(rc::gen::container<std::vector<std::uint32_t>>(rc::gen::inRange<std::uint32_t>(0, 2)),
                           [](const auto& p) { return p.size() <= 64 && std::ranges::count(p, 1u) > 0; });
    VoiceOptions options;
    options.stride = 1;
    const auto played = places(voice_of(finger_with(points), options));
    const double turn = 2 * std::numbers::pi / static_cast<double>(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
      double best = 10;
      double chosen = -1;
      for (std::size_t other = 0; other < points.size(); ++other) {
        if (points[other] == 0) continue;
        const double a = turn * static_cast<double>(n), b = turn * static_cast<double>(other);
        const double apart = std::acos(std::clamp(std::cos(a) * std::cos(b) + std::sin(a) * std::sin(b), -1.0, 1.0));
        if (apart < best - 1e-6) best = apart, chosen = static_cast<double>(other);
      }
      RC_ASSERT(played[n] == chosen);
    }
  }));
}

TEST(Voice, PointLikeFingersAreModulated) {
  touch::Finger finger = finger_with({2});
  finger.point_like = true;
  const Voice voice = voice_of(finger);
  EXPECT_EQ(places(voice), std::vector<double>{-1}) << "the centroid";
  EXPECT_EQ(voice.order, std::vector<std::uint32_t>{0});
  EXPECT_EQ(voice.modulation_hz, 200);
}

TEST(Voice, WithoutAnyFocusThereIsTheCentroid) {
  EXPECT_EQ(places(voice_of(finger_with({0, 0, 0}))), std::vector<double>{-1});
  EXPECT_EQ(places(voice_of(finger_with({}))), std::vector<double>{-1});
}

TEST(Schedule, SlotsFollowTheOrder) {
  const Schedule schedule = schedule_of(voice_of(finger_with(std::vector<std::uint32_t>(10, 1))));
  std::vector<SlotFocus> foci;
  for (std::uint64_t slot = 0; slot < 35; ++slot) {
    foci_of_slot(schedule, slot, foci);
    ASSERT_EQ(foci.size(), 1u);
    EXPECT_EQ(foci[0].position.x, fill_order(10, 3)[slot % 10]);
    EXPECT_EQ(foci[0].gain, 1.0F);
  }
}

TEST(Schedule, TogetherPlaysAllInEverySlot) {
  VoiceOptions options;
  options.stride = 5;  // not coprime, but there is no order to fill
  options.modulation_hz = 0;
  const Schedule schedule =
      schedule_of(voice_of(finger_with(std::vector<std::uint32_t>(10, 1)), options, touch::Method::multi_focus));
  std::vector<SlotFocus> foci;
  for (const std::uint64_t slot : {0u, 1u, 17u}) {
    foci_of_slot(schedule, slot, foci);
    ASSERT_EQ(foci.size(), 10u);
    for (int n = 0; n < 10; ++n)
      EXPECT_EQ(foci[n].position.x, n);
  }
  EXPECT_EQ(cycle_length(schedule, 100), 1u);
}

TEST(Schedule, TogetherLeavesEmptySectorsOut) {
  const Voice voice = voice_of(finger_with({0, 1, 1, 0, 1}), {}, touch::Method::multi_focus);
  EXPECT_EQ(places(voice), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(voice.order, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(voice.foci_per_slot, 3u);
  EXPECT_EQ(voice.modulation_hz, 200) << "nothing moves";
}

TEST(Schedule, AVoicesOwnDwell) {
  Voice voice = voice_of(finger_with(std::vector<std::uint32_t>(10, 1)));
  voice.dwell_s = 4e-3;
  const Schedule schedule = schedule_of(voice);  // ticks of 1.5 ms
  std::vector<SlotFocus> foci;
  for (std::uint64_t slot = 0; slot < 1000; ++slot) {
    foci_of_slot(schedule, slot, foci);
    // 1.5 / 4 = 3 / 8.
    EXPECT_EQ(foci[0].position.x, voice.order[slot * 3 / 8 % 10]) << slot;
  }
}

TEST(Schedule, NoRoundingMakesAStepLate) {
  // 3 dwells of 0.1 ms are 0.3 ms, which floating point denies.
  Voice voice = voice_of(finger_with(std::vector<std::uint32_t>(7, 1)));
  std::vector<SlotFocus> foci;
  for (const double dwell : {1e-4, 1.1e-4, 7e-4, 1.5e-3, 0.3}) {
    for (const int ratio : {1, 3, 6, 7}) {
      voice.dwell_s = dwell * ratio;
      Schedule schedule = schedule_of(voice);
      schedule.slot_s = dwell;
      for (const std::uint64_t begin : {std::uint64_t{0}, std::uint64_t{1} << 32}) {
        for (std::uint64_t slot = begin; slot < begin + 100; ++slot) {
          foci_of_slot(schedule, slot, foci);
          ASSERT_EQ(foci[0].position.x, voice.order[slot / ratio % 7]) << dwell << " " << ratio << " " << slot;
        }
      }
    }
  }
}

/// Slots that each sector gets in ten seconds of frames at 90 Hz.
std::vector<int> dwell_of_sectors(bool restart) {
  Schedule schedule;
  std::vector<int> dwell(10);
  std::vector<SlotFocus> foci;
  const double frame_s = 1.0 / 90;
  std::uint64_t frame_begin = 0;
  int frame = -1;
  for (std::uint64_t slot = 0; slot < static_cast<std::uint64_t>(10 / schedule.slot_s); ++slot) {
    const int now = static_cast<int>(static_cast<double>(slot) * schedule.slot_s / frame_s);
    if (now != frame) {
      frame = now;
      frame_begin = slot;
      schedule.clear();
      make_voice(placed(finger_with(std::vector<std::uint32_t>(10, 1))), 0, 0, {}, schedule.add_voice());
    }
    foci_of_slot(schedule, restart ? slot - frame_begin : slot, foci);
    ++dwell[static_cast<std::size_t>(foci.at(0).position.x)];
  }
  return dwell;
}

TEST(Schedule, TenSecondsOfFramesGiveEverySectorTheSameDwell) {
  const auto dwell = dwell_of_sectors(false);
  EXPECT_EQ(std::accumulate(dwell.begin(), dwell.end(), 0), 6666);
  const auto [least, most] = std::ranges::minmax(dwell);
  EXPECT_LE(most - least, 1);
}

TEST(Schedule, RestartingEveryFrameWouldStarveSectors) {
  const auto dwell = dwell_of_sectors(true);
  const auto [least, most] = std::ranges::minmax(dwell);
  EXPECT_EQ(least, 0);
  EXPECT_GT(most, 800);
}

TEST(Schedule, IsReusedWithoutAllocating) {
  Schedule schedule;
  std::vector<SlotFocus> foci;
  const touch::Finger finger = finger_with(std::vector<std::uint32_t>(10, 1));
  touch::Placement placement;
  const void* storage[4] = {};
  for (int frame = 0; frame < 3; ++frame) {
    schedule.clear();
    for (std::uint32_t id = 0; id < 5; ++id) {
      touch::place_foci({}, finger, {}, placement);
      make_voice(placement, id, 0, {}, schedule.add_voice());
    }
    foci_of_slot(schedule, 0, foci);
    const void* now[4] = {schedule.voices[4].foci.data(), schedule.voices[4].order.data(), foci.data(),
                          placement.foci.data()};
    EXPECT_TRUE(frame == 0 || std::ranges::equal(now, storage));
    std::ranges::copy(now, storage);
  }
  EXPECT_EQ(schedule.voice_count, 5u);
}

TEST(Schedule, HasNoFociWithoutVoices) {
  Schedule schedule;
  std::vector<SlotFocus> foci{{}};
  foci_of_slot(schedule, 3, foci);
  EXPECT_TRUE(foci.empty());
  schedule.add_voice() = voice_of(finger_with({1}));
  foci_of_slot(schedule, 3, foci);
  EXPECT_EQ(foci.size(), 1u);
  schedule.clear();
  foci_of_slot(schedule, 3, foci);
  EXPECT_TRUE(foci.empty());
}

TEST(Modulation, IsASineFromNoneToFull) {
  constexpr auto amplitude = Modulation::amplitude_sine;
  EXPECT_EQ(modulation_gain(amplitude, 0, 12.3), 1);
  EXPECT_DOUBLE_EQ(modulation_gain(amplitude, 200, 0), 0.5);
  EXPECT_DOUBLE_EQ(modulation_gain(amplitude, 200, 1.25e-3), 1);
  EXPECT_NEAR(modulation_gain(amplitude, 200, 3.75e-3), 0, 1e-15);
  EXPECT_NEAR(modulation_gain(amplitude, 200, 1000.00125), 1, 1e-9);
}

TEST(Modulation, OfThePressureIsTheSquareRoot) {
  constexpr auto pressure = Modulation::pressure_sine;
  EXPECT_EQ(modulation_gain(pressure, 0, 12.3), 1);
  for (double t = 0; t < 0.02; t += 1.7e-4) {
    const double gain = modulation_gain(pressure, 200, t);
    EXPECT_NEAR(gain * gain, 0.5 + 0.5 * std::sin(400 * std::numbers::pi * t), 1e-12) << t;
  }
}

TEST(Modulation, GainsAreSampledAtSlotMidpoints) {
  Voice voice = voice_of(finger_with({1}));
  voice.modulation_hz = 200;
  voice.modulation = Modulation::amplitude_sine;
  const Schedule schedule = schedule_of(voice);
  std::vector<SlotFocus> foci;
  double mean = 0;
  for (std::uint64_t slot = 0; slot < 10; ++slot) {
    foci_of_slot(schedule, slot, foci);
    const double t = (static_cast<double>(slot) + 0.5) * 1.5e-3;
    EXPECT_NEAR(foci[0].gain, 0.5 + 0.5 * std::sin(400 * std::numbers::pi * t), 1e-6);
    mean += foci[0].gain / 10;
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
  make_voice(placed(finger_with(std::vector<std::uint32_t>(10, 1))), 0, 0, {}, schedule.add_voice());
  EXPECT_EQ(cycle_length(schedule, 10), 10u);
  EXPECT_EQ(cycle_length(schedule, 9), 0u);
  make_voice(placed(finger_with(std::vector<std::uint32_t>(7, 1))), 1, 0, {}, schedule.add_voice());
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

TEST(Cycle, FociAndGainsRepeatAfterItAndNotBefore) {
  EXPECT_TRUE(rc::check([] {
    Schedule schedule;
    schedule.slot_s = *rc::gen::element(1e-3, 1.5e-3, 2e-3, 0.1e-3);
    const auto voices = *rc::gen::inRange(1, 4);
    for (int v = 0; v < voices; ++v) {
      Voice& voice = schedule.add_voice();
      voice = voice_of(finger_with(std::vector<std::uint32_t>(*rc::gen::element<std::size_t>(1, 5, 7, 10), 1)));
      voice.dwell_s = schedule.slot_s * *rc::gen::element(1.0, 1.5, 2.0, 3.0);
      voice.modulation_hz = *rc::gen::element(0.0, 100.0, 200.0, 250.0);
    }
    const std::uint64_t cycle = cycle_length(schedule, 100000);
    RC_ASSERT(cycle > 0);
    const auto repeats_after = [&](std::uint64_t length) {
      std::vector<SlotFocus> a, b;
      for (std::uint64_t slot = 0; slot < cycle; ++slot) {
        foci_of_slot(schedule, slot, a);
        foci_of_slot(schedule, slot + length, b);
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
