// Gains that change from slot to slot: by depth, by texture, and in a window of slots.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "array/course.hpp"
#include "array/schedule.hpp"

namespace palpa::array {
namespace {

constexpr double slot_s = 1.5e-3;

/// The force in each slot: the square of the gain.
std::vector<double> forces(const Course& course, std::uint64_t slots) {
  std::vector<double> list;
  for (std::uint64_t slot = 0; slot < slots; ++slot)
    list.push_back(std::pow(modulate(course, slot, slot_s), 2));
  return list;
}

/// The amplitude of the sine of that frequency in a sequence of slots.
double line(const std::vector<double>& slots, double hz) {
  std::complex<double> sum = 0;
  for (std::size_t slot = 0; slot < slots.size(); ++slot)
    sum += std::polar(slots[slot], -2 * std::numbers::pi * hz * slot_s * static_cast<double>(slot));
  return 2 * std::abs(sum) / static_cast<double>(slots.size());
}

/// A finger that moves along x, with all of the vibrations. 200 slots are whole periods of 30 and of 150 Hz.
Course moving(const Texture& texture, double grains_per_slot) {
  Course course{.slots = 200, .texture = texture};
  course.from.motion = course.to.motion = 1;
  course.from.place = {5, 0, 10};
  course.to.place = course.from.place + Vec3(200 * grains_per_slot, 0, 0);
  return course;
}

TEST(Course, DoesNothingByItself) {
  const Course course;
  EXPECT_FALSE(course.changes());
  for (const std::uint64_t slot : {0ULL, 1ULL, 12345678901ULL})
    EXPECT_EQ(modulate(course, slot, slot_s), 1);
}

TEST(Course, GoesFromOneForceToTheNextInEvenSteps) {
  Course course{.first_slot = 100, .slots = 8};
  course.from.force = 0.2;
  course.to.force = 1;
  EXPECT_TRUE(course.changes());
  for (const std::uint64_t slot : {0, 99, 100})
    EXPECT_NEAR(std::pow(modulate(course, slot, slot_s), 2), 0.2, 1e-12) << slot;
  for (std::uint64_t slot = 100; slot < 108; ++slot)
    EXPECT_NEAR(std::pow(modulate(course, slot, slot_s), 2), 0.2 + 0.1 * static_cast<double>(slot - 100), 1e-12);
  for (const std::uint64_t slot : {108, 109, 5000})
    EXPECT_EQ(modulate(course, slot, slot_s), 1);
  course.slots = 0;
  EXPECT_EQ(modulate(course, 0, slot_s), 1) << "at once";
}

TEST(Course, IsSilentOutsideOfItsSlots) {
  const Course course{.begin_slot = 5, .end_slot = 9};
  EXPECT_TRUE(course.changes());
  for (std::uint64_t slot = 0; slot < 20; ++slot)
    EXPECT_EQ(modulate(course, slot, slot_s), slot >= 5 && slot < 9 ? 1 : 0) << slot;
}

TEST(Course, PlaysGainsThatItIsGiven) {
  const Course course{.first_slot = 10, .gains = {0.5F, 0.25F, 1}};
  EXPECT_TRUE(course.changes());
  const double expected[] = {0.5, 0.5, 0.25, 1, 1};
  for (std::uint64_t n = 0; n < 5; ++n)
    EXPECT_EQ(modulate(course, 9 + n, slot_s), expected[n]);
}

TEST(Course, TheNoiseIsSmoothAndTheSameEverywhere) {
  EXPECT_NEAR(noise_at({0, 0, 0}, 1), 0.12118972835160546, 1e-15);
  EXPECT_NEAR(noise_at({1, 2, 3}, 1), 0.1327414087313964, 1e-15);
  EXPECT_NEAR(noise_at({-1, -2, -3}, 2), 0.6440382747632158, 1e-15);
  EXPECT_NEAR(noise_at({0.5, 0.25, -0.75}, 1), 0.5637647792983846, 1e-12);
  double least = 1, most = 0, sum = 0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const Vec3 at(0.01 * i, 0.003 * i - 20, -0.007 * i);
    const double value = noise_at(at, 1);
    EXPECT_LT(std::abs(noise_at(at + Vec3(1e-3, 0, 0), 1) - value), 3e-3);
    least = std::min(least, value);
    most = std::max(most, value);
    sum += value;
  }
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 1);
  EXPECT_GT(most - least, 0.8);
  EXPECT_NEAR(sum / steps, 0.5, 0.05);
  for (const double far : {1e300, -1e300, 1e9})
    EXPECT_TRUE(noise_at({far, 0, far}, 1) >= 0 && noise_at({far, 0, far}, 1) <= 1);
}

TEST(Course, ATextureHasItsTwoLinesByTheirWeights) {
  const std::vector<double> both = forces(moving({0.2, 1, 0.6}, 0), 200);
  EXPECT_GT(line(both, low_hz), 0.02);
  EXPECT_GT(line(both, high_hz), 0.01);
  for (const double hz : {10.0, 60.0, 90.0, 120.0, 200.0})
    EXPECT_LT(line(both, hz), 1e-9) << hz;
  const std::vector<double> low = forces(moving({0.5, 0.5, 0}, 0), 200), high = forces(moving({0.5, 0, 0.5}, 0), 200);
  EXPECT_LT(line(low, high_hz), 1e-9);
  EXPECT_LT(line(high, low_hz), 1e-9);
  // The noise at the place, times the weight, is the height of the sine.
  const Vec3 place(5, 0, 10);
  EXPECT_NEAR(line(low, low_hz), 0.25 * noise_at(place, 1), 1e-9);
  EXPECT_NEAR(line(high, high_hz), 0.25 * noise_at(place, 2), 1e-9);
}

TEST(Course, NoTextureIsLouderThanWithoutIt) {
  for (const Texture& texture : {Texture{0, 1, 1}, Texture{1, 1, 1}, Texture{0, 0, 1}, Texture{1e-3, 1, 0}}) {
    for (const double force : forces(moving(texture, 0.03), 2000))
      EXPECT_TRUE(force >= 0 && force <= 1) << force;
  }
}

TEST(Course, FasterMotionSpreadsTheLines) {
  const auto beside = [](double grains_per_slot) {
    const std::vector<double> slots = forces(moving({0, 1, 0}, grains_per_slot), 200);
    double sum = 0;
    for (const int periods : {6, 7, 8, 10, 11, 12})  // in 0.3 s; 30 Hz has 9
      sum += line(slots, periods / 0.3);
    return sum;
  };
  EXPECT_LT(beside(1e-4), 1e-3);
  EXPECT_GT(beside(0.03), 0.1);  // 20 grains a second
}

TEST(Course, AFingerAtRestFeelsTheSteadyPartOnly) {
  Course course = moving({0.25, 1, 0.75}, 0);
  course.from.motion = course.to.motion = 0;
  EXPECT_FALSE(course.changes());
  EXPECT_NEAR(modulate(course, 77, slot_s), std::sqrt(0.125), 1e-12);
}

TEST(Course, IsPartOfASchedule) {
  Schedule schedule;
  for (int v = 0; v < 2; ++v) {
    Voice& voice = schedule.add_voice();
    voice.foci = {Vec3(v, 0, 0)};
    voice.order = {0};
    voice.gain = 0.5;
  }
  EXPECT_FALSE(changes(schedule));
  EXPECT_EQ(cycle_length(schedule, 100), 1U);
  EXPECT_EQ(first_changing_slot(schedule), 0U);
  schedule.voices[1].course = {.first_slot = 40, .gains = {0.5F}};
  EXPECT_TRUE(changes(schedule));
  EXPECT_FALSE(shared_modulation(schedule)) << "the two differ";
  EXPECT_EQ(cycle_length(schedule, 100), 0U) << "gains do not repeat";
  EXPECT_EQ(first_changing_slot(schedule), 40U);
  std::vector<SlotFocus> foci;
  foci_of_slot(schedule, 50, foci);
  ASSERT_EQ(foci.size(), 2U);
  EXPECT_EQ(foci[0].gain, 0.5F);
  EXPECT_EQ(foci[1].gain, 0.25F);
  schedule.voices[0].course = schedule.voices[1].course;
  EXPECT_TRUE(shared_modulation(schedule));
}

}  // namespace
}  // namespace palpa::array
