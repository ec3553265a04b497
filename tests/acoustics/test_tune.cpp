// The choices of --tune, against an exhaustive search; and a live finger's stride does not flip.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numeric>
#include <string>

#include "acoustics/felt/tune.hpp"

namespace palpa::acoustics {
namespace {

Ring ring(double perimeter, std::uint32_t foci = 10, std::uint32_t stride = 3, double dwell = 1.5e-3) {
  return {perimeter, foci, stride, dwell};
}

Felt felt_of(const Ring& ring) {
  return felt(spectrum_of(ring));
}

TEST(Tune, ReportsWhatTheSpectrumIsFeltAs) {
  for (const double perimeter : {3e-3, 15e-3, 30e-3, 50e-3, 90e-3}) {
    const Tuned tuned = tune(ring(perimeter));
    EXPECT_NEAR(tuned.before.vibration, felt_of(ring(perimeter)).vibration, 1e-9);
    EXPECT_NEAR(tuned.before.flutter, felt_of(ring(perimeter)).flutter, 1e-9);
    EXPECT_NEAR(tuned.after.vibration, felt_of(tuned.ring).vibration, 1e-9);
    EXPECT_NEAR(tuned.after.flutter, felt_of(tuned.ring).flutter, 1e-9);
  }
}

TEST(Tune, KeepsThePapersChoiceOnASmallPerimeter) {
  const Tuned tuned = tune(ring(15e-3));
  EXPECT_FALSE(tuned.changed);
  EXPECT_EQ(tuned.ring.foci, 10u);
  EXPECT_EQ(tuned.ring.stride, 3u);
  EXPECT_NEAR(tuned.after.vibration, 0.685, 0.001);
}

/// The strongest of a ring's lines from `low_hz` to `high_hz`.
double strongest(const Ring& ring, double low_hz, double high_hz) {
  double most = 0;
  for (const Line& line : spectrum_of(ring).lines) {
    if (line.frequency_hz >= low_hz && line.frequency_hz <= high_hz) most = std::max(most, line.around);
  }
  return most;
}

TEST(Tune, DoesNotBuyVibrationWithFlutter) {
  for (const double perimeter : {35e-3, 44e-3, 50e-3}) {
    // More of the energy is felt as vibration, but there is also a line of 29 Hz that is about as strong.
    const Ring tempting = ring(perimeter, 23, 8);
    EXPECT_GT(felt_of(tempting).vibration, 1.05 * felt_of(ring(perimeter)).vibration);
    EXPECT_GT(strongest(tempting, 5, 50), 0.85 * strongest(tempting, 150, 250));
    for (const std::uint32_t stride : {1u, 3u}) {
      const Tuned tuned = tune(ring(perimeter, 10, stride));
      EXPECT_LT(strongest(tuned.ring, 5, 50), 0.2 * strongest(tuned.ring, 150, 250)) << perimeter << " " << stride;
      EXPECT_LT(tuned.after.flutter, 0.06);
      EXPECT_GT(tuned.after.vibration, stride == 1 ? 1.05 * tuned.before.vibration : 0.44);
    }
  }
}

TEST(Tune, NothingElseIsBetter) {
  for (const double perimeter : {12e-3, 24e-3, 37e-3, 50e-3, 70e-3}) {
    const Tuned tuned = tune(ring(perimeter));
    for (std::uint32_t foci = 10; foci <= 24; ++foci) {
      for (std::uint32_t stride = 1; stride < foci; ++stride) {
        if (std::gcd(foci, stride) != 1) continue;
        const double gained = balance(felt_of(ring(perimeter, foci, stride))) - balance(tuned.after);
        EXPECT_LE(gained, tuned.changed ? 1e-6 : 0.05 * tuned.before.vibration)
            << perimeter << " " << foci << " " << stride;
      }
    }
  }
}

TEST(Tune, MayChooseTheDwellWithinARange) {
  TuneOptions options;
  options.shortest_dwell_s = 0.5e-3;
  options.longest_dwell_s = 2e-3;
  for (const double perimeter : {15e-3, 50e-3}) {
    const Tuned fixed = tune(ring(perimeter)), free = tune(ring(perimeter), options);
    EXPECT_GE(balance(free.after), balance(fixed.after));
    const double grows_by = perimeter < 20e-3 ? 1.05 : 0.95;
    EXPECT_GT(free.after.vibration, grows_by * fixed.after.vibration);
    EXPECT_GE(free.ring.dwell_s, 0.5e-3);
    EXPECT_LE(free.ring.dwell_s, 2e-3);
    EXPECT_NEAR(free.ring.dwell_s * 1e4, std::round(free.ring.dwell_s * 1e4), 1e-9) << "whole tenths";
  }
  // A dwell at an end of the range is within it, and changes only if that is worth it.
  for (double perimeter = 10e-3; perimeter < 60e-3; perimeter += 5e-3) {
    const acoustics::Ring own = ring(perimeter);
    TuneOptions only;
    only.shortest_dwell_s = only.longest_dwell_s = own.dwell_s;
    EXPECT_EQ(tune(own, only).changed, tune(own).changed) << perimeter;
  }
  // A dwell outside the range has to change, at any cost.
  options.shortest_dwell_s = options.longest_dwell_s = 1e-2;
  const Tuned slow = tune(ring(15e-3), options);
  EXPECT_TRUE(slow.changed);
  EXPECT_DOUBLE_EQ(slow.ring.dwell_s, 1e-2);
}

/// Most tenths of a millisecond are no doubles, and those that people write differ from those that are computed.
TEST(Tune, BothEndsOfARangeAreInIt) {
  for (int tenths = 1; tenths <= 200; ++tenths) {
    for (const double dwell_s : {std::stod(std::to_string(tenths) + "e-4"), 1e-3 * (tenths / 10.0), tenths / 1e4}) {
      TuneOptions options;
      options.shortest_dwell_s = options.longest_dwell_s = dwell_s;
      EXPECT_NEAR(tune(ring(15e-3, 10, 3, 30e-3), options).ring.dwell_s, dwell_s, 1e-12) << tenths;
    }
  }
}

TEST(Tune, AlwaysGivesEveryFocusItsTurnAndNeverLessThanBefore) {
  EXPECT_TRUE(rc::check([] {
    const auto foci = *rc::gen::inRange<std::uint32_t>(1, 65);
    const auto stride = *rc::gen::suchThat(rc::gen::inRange<std::uint32_t>(1, 65),
                                           [&](std::uint32_t s) { return std::gcd(foci, s) == 1; });
    const double perimeter = *rc::gen::inRange(0, 200) * 1e-3;
    const double dwell = *rc::gen::element(0.25e-3, 1.5e-3, 10e-3);
    const Tuned tuned = tune(ring(perimeter, foci, stride, dwell));
    RC_ASSERT(std::gcd(tuned.ring.foci, tuned.ring.stride) == 1);
    RC_ASSERT(tuned.ring.foci >= foci && tuned.ring.foci <= std::max(24u, foci));
    RC_ASSERT(tuned.ring.dwell_s == dwell && tuned.ring.perimeter_m == perimeter);
    RC_ASSERT(balance(tuned.after) >= balance(tuned.before));
    RC_ASSERT(tuned.changed || (tuned.ring.foci == foci && tuned.ring.stride == stride));
    const Tuned again = tune(ring(perimeter, foci, stride, dwell));
    RC_ASSERT(again.ring.foci == tuned.ring.foci && again.ring.stride == tuned.ring.stride);
    // No further gain is possible.
    RC_ASSERT(!tune(tuned.ring).changed);
  }));
}

TEST(Tune, WithoutAPerimeterThereIsNothingToChoose) {
  for (const Ring& r : {ring(0), ring(-1), ring(std::nan("")), ring(20e-3, 2, 1), ring(20e-3, 1, 1)}) {
    const Tuned tuned = tune(r);
    EXPECT_FALSE(tuned.changed);
    EXPECT_EQ(tuned.ring.foci, r.foci);
    EXPECT_EQ(tuned.ring.stride, r.stride);
  }
}

TEST(StrideTuner, ChoosesAtAFingersFirstFrame) {
  StrideTuner tuner;
  EXPECT_EQ(tuner.stride_for(7, ring(15e-3, 10, 1), 0), 3u);
  EXPECT_EQ(tuner.stride_for(8, ring(15e-3, 10, 3), 0), 3u);
  EXPECT_EQ(tuner.stride_for(9, ring(0, 10, 1), 0), 1u) << "no perimeter: what was asked for";
}

/// With 16 foci, the best stride depends on the perimeter: the perimeter at which two are about equally good.
double border_of(std::uint32_t foci, std::uint32_t& small, std::uint32_t& large) {
  const auto best = [&](double perimeter) { return StrideTuner().stride_for(0, ring(perimeter, foci, 1), 0); };
  small = best(10e-3);
  for (double perimeter = 10e-3; perimeter < 90e-3; perimeter += 0.1e-3) {
    large = best(perimeter);
    if (large != small) return perimeter;
  }
  return 0;
}

TEST(StrideTuner, DoesNotFlipWhereTwoAreAsGood) {
  for (const std::uint32_t foci : {13u, 16u, 21u}) {
    std::uint32_t small = 0, large = 0;
    const double border = border_of(foci, small, large);
    ASSERT_GT(border, 0) << foci;
    StrideTuner tuner;
    std::uint32_t last = 0, changes = 0;
    for (int frame = 0; frame < 900; ++frame) {
      const double perimeter = border + (frame % 2 ? 0.3e-3 : -0.3e-3);
      const std::uint32_t stride = tuner.stride_for(3, ring(perimeter, foci, 1), frame / 90.0);
      changes += frame > 0 && stride != last;
      last = stride;
    }
    EXPECT_EQ(changes, 0u) << foci;
  }
}

TEST(StrideTuner, FollowsALastingChangeOnceItHasRested) {
  StrideTuner tuner;
  // Seven foci with a dwell of 3 ms: the first harmonic alone, or all harmonics.
  EXPECT_EQ(tuner.stride_for(1, ring(15e-3, 10, 1, 1.5e-3), 0), 3u);
  // With this dwell, stride 3 of ten is wrong. The best stride is then taken, but not at once.
  const std::uint32_t slow = StrideTuner().stride_for(1, ring(15e-3, 10, 3, 0.5e-3), 0);
  ASSERT_EQ(slow, 1u) << "200 Hz is the first line";
  EXPECT_EQ(tuner.stride_for(1, ring(15e-3, 10, 1, 0.5e-3), 0.2), 3u);
  EXPECT_EQ(tuner.stride_for(1, ring(15e-3, 10, 1, 0.5e-3), 0.6), 1u);
  EXPECT_EQ(tuner.stride_for(1, ring(15e-3, 10, 1, 1.5e-3), 0.7), 1u);
  EXPECT_EQ(tuner.stride_for(1, ring(15e-3, 10, 1, 1.5e-3), 1.2), 3u);
}

TEST(StrideTuner, AFingerWithAnotherNumberOfFociIsAsNew) {
  for (const std::uint32_t before : {5u, 10u, 21u}) {
    for (const std::uint32_t foci : {6u, 8u, 9u, 13u, 16u, 20u}) {
      StrideTuner tuner;
      tuner.stride_for(1, ring(15e-3, before, 1), 0);
      tuner.learn(1, Harmonics(20e-3, before, 10e-3), 0);
      tuner.stride_for(1, ring(15e-3, before, 1), 0.01);
      ASSERT_FALSE(tuner.wants(1, 0.02));
      const std::uint32_t stride = tuner.stride_for(1, ring(25e-3, foci, 1), 0.02);
      EXPECT_EQ(std::gcd(stride, foci), 1u) << "every focus has its turn";
      EXPECT_EQ(stride, StrideTuner().stride_for(1, ring(25e-3, foci, 1), 0.02)) << before << ' ' << foci;
      EXPECT_TRUE(tuner.wants(1, 0.02)) << "those that it knows are of other foci";
      tuner.learn(1, Harmonics(20e-3, foci, 10e-3), 0.02);
      EXPECT_FALSE(tuner.wants(1, 0.03));
    }
  }
}

TEST(StrideTuner, ForgetsTheOneSeenLongestAgoWhateverTheClockSays) {
  const Ring usual = ring(15e-3, 10, 1);
  // A clock that stands still, and a clock that is set back before the second half.
  for (const double back_s : {0.0, 5.0}) {
    StrideTuner tuner;
    const auto fingers = [&](std::uint32_t first, std::uint32_t last, double time_s) {
      for (std::uint32_t id = first; id < last; ++id)
        tuner.stride_for(id, usual, time_s);
    };
    fingers(0, 64, 10);
    fingers(0, 32, 10 - back_s);   // seen again: 32 is the oldest
    fingers(64, 70, 10 - back_s);  // six more than there is room for
    for (std::uint32_t id = 0; id < 70; ++id)
      EXPECT_EQ(tuner.wants(id, 10), id < 32 || id >= 38) << "finger " << id << ", back by " << back_s << " s";
  }
}

}  // namespace
}  // namespace palpa::acoustics
