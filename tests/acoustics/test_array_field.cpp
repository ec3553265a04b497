// An array's field around foci and its spectrum on a ring, against plain sums over transducers.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>
#include <thread>
#include <utility>

#include "acoustics/felt/harmonics.hpp"
#include "acoustics/felt/tune.hpp"
#include "acoustics/field/array_field.hpp"
#include "acoustics/field/asked_field.hpp"
#include "acoustics/field/pressure.hpp"
#include "acoustics/rigs.hpp"
#include "array/drive.hpp"
#include "array/focus_sets.hpp"

namespace palpa::acoustics {
namespace {

using array::Layout;
constexpr double pi = std::numbers::pi;

/// Foci on a horizontal circle.
std::vector<Vec3> circle(double radius, std::uint32_t count) {
  std::vector<Vec3> foci;
  for (std::uint32_t n = 0; n < count; ++n)
    foci.emplace_back(radius * std::cos(2 * pi * n / count), -1e-3, radius * std::sin(2 * pi * n / count));
  return foci;
}

array::Voice voice_of(const std::vector<Vec3>& foci, std::uint32_t stride) {
  array::Voice voice;
  voice.foci = foci;
  voice.order = array::fill_order(static_cast<std::uint32_t>(foci.size()), stride);
  return voice;
}

double felt_share(const array::Voice& voice, const FocusField& field) {
  return felt(spectrum_of(voice, 1.5e-3, {.field = &field})).vibration;
}

TEST(ArrayField, IsThePressureOfTheDriveOfEachFocusAlone) {
  const Layout layout = posed("autd3");
  array::Medium cold;
  cold.sound_speed = 335;
  for (const array::DriveOptions& drive :
       {array::DriveOptions(), array::DriveOptions{.medium = cold, .directivity = array::Directivity::piston},
        array::DriveOptions{.weighting = array::Weighting::uniform},
        array::DriveOptions{.constraint = array::Constraint::uniform}}) {
    const ArrayField field(layout, drive);
    const std::vector<Vec3> path = path_through(circle(6e-3, 5), 3);
    std::vector<double> felt;
    ASSERT_TRUE(field.felt(path, 3, felt));
    ASSERT_EQ(felt.size(), 5u * 15u);
    double unit = 0;
    for (std::size_t focus = 0; focus < 5; ++focus) {
      const std::array<array::SlotFocus, 1> alone{array::SlotFocus{path[3 * focus], 1}};
      const array::Drive driven = array::drive_for(layout, alone, drive);
      for (std::size_t place = 0; place < path.size(); ++place) {
        const double p = std::norm(pressure_at(layout, driven, path[place], drive.medium, drive.directivity));
        if (unit == 0) unit = p / felt[0];
        EXPECT_NEAR(felt[focus * path.size() + place] * unit, p, 1e-3 * felt[0] * unit) << focus << " at " << place;
      }
    }
  }
}

TEST(ArrayField, WhereAPressureIsAskedForEveryFocusHasIt) {
  const Layout layout = posed("autd3");
  const ArrayField field(layout, {});
  const AskedField asked(field);
  const std::vector<Vec3> path = path_through(circle(12e-3, 5), 3);
  std::vector<double> felt;
  ASSERT_TRUE(asked.felt(path, 3, felt));
  constexpr double pa = 500;
  for (std::size_t focus = 0; focus < 5; ++focus) {
    const array::SlotFocus alone{.position = path[3 * focus], .pressure_pa = pa};
    const array::Drive driven = array::drive_for(layout, {&alone, 1}, {});
    for (std::size_t place = 0; place < path.size(); ++place) {
      const double p = std::abs(pressure_at(layout, driven, path[place], {}, array::Directivity::t4010a1));
      EXPECT_NEAR(felt[focus * path.size() + place], p * p / (pa * pa), 2e-3) << focus << " at " << place;
    }
  }
  std::vector<Vec3> aside = circle(12e-3, 10);
  for (Vec3& focus : aside)
    focus.x += 80e-3;
  array::Voice voice = voice_of(aside, 3);
  const double without = felt_share(voice, field);
  voice.pressure_pa = pa;
  EXPECT_DOUBLE_EQ(felt_share(voice, asked), felt_share(voice, field)) << "as if the field were that";
  EXPECT_NE(felt_share(voice, field), without) << "some of them are farther from the array";
}

TEST(ArrayField, GivesUpWhenTold) {
  const Layout layout = posed("autd3");
  const ArrayField field(layout, {});
  std::vector<double> felt;
  const std::atomic<bool> at_once{true}, never{false};
  EXPECT_FALSE(field.felt(circle(6e-3, 5), 1, felt, &at_once));
  EXPECT_TRUE(field.felt(circle(6e-3, 5), 1, felt, &never));
  const PathField unknown(field, circle(6e-3, 5), &at_once);
  EXPECT_EQ(unknown.harmonics(5).felt(2, 1.5e-3, 1000).vibration, 0);
}

TEST(PathField, GivesUpInTheMiddleOfItsSeries) {
  // One transducer and many places: the field is ready at once, its series takes seconds.
  Layout layout = posed("autd3");
  layout.transducers.resize(1);
  layout.boards.clear();
  const ArrayField field(layout, {});
  std::atomic<bool> give_up{false};
  std::thread soon([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    give_up = true;
  });
  const PathField unknown(field, circle(0.1, 1000), &give_up);
  EXPECT_TRUE(give_up) << "it was not in the middle";
  soon.join();
  EXPECT_EQ(unknown.harmonics(10).felt(3, 1.5e-3, 1000).vibration, 0);
  EXPECT_EQ(unknown.harmonics(10).felt(3, 1.5e-3, 1000).flutter, 0);
}

TEST(ArrayField, PathsHaveTheFociInThemAndNoLongStep) {
  const std::vector<Vec3> foci = circle(5.5e-3, 10);
  const std::size_t per_side = steps_per_side(foci, 1.43e-3);
  EXPECT_EQ(per_side, 3u) << "sides of 3.40 mm";
  const std::vector<Vec3> path = path_through(foci, per_side);
  ASSERT_EQ(path.size(), 30u);
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LE(glm::distance(path[i], path[(i + 1) % path.size()]), 1.43e-3);
    if (i % per_side != 0) continue;
    EXPECT_EQ(path[i], foci[i / per_side]);
  }
  EXPECT_EQ(steps_per_side(std::vector<Vec3>(4, Vec3(1, 2, 3)), 1e-3), 1u) << "all in one place";
  EXPECT_EQ(steps_per_side(circle(1, 10), 1e-3), most_path_places / 10) << "as many as there may be";
  EXPECT_EQ(steps_per_side(circle(1, 200), 1e-3), 1u);
}

/// The share of the energy that is felt as vibration on a ring of ten foci in the paper's order, computed only with
/// sums: every transducer's wave at places of a finely divided path, and the Fourier integral of its steps.
double summed_share(const Layout& layout, double radius) {
  constexpr double wavelength = 343.21 / 40e3, dwell = 1.5e-3;
  constexpr int foci = 10, per_side = 5, places = foci * per_side;
  const double ka = 2 * pi / wavelength * layout.transducer_radius_m;
  const std::vector<Vec3> ring = circle(radius, foci);
  // pressure[focus][place]
  std::vector<std::array<double, places>> pressure(foci);
  std::vector<Vec3> path;
  for (int n = 0; n < places; ++n) {
    const double part = n % per_side / double{per_side};
    path.push_back(ring[n / per_side] * (1 - part) + ring[(n / per_side + 1) % foci] * part);
  }
  std::vector<std::array<std::complex<double>, places>> waves(foci);
  for (const array::Transducer& t : layout.transducers) {
    std::array<std::complex<double>, places> heard;
    for (int i = 0; i < places; ++i) {
      const Vec3 way = path[i] - t.position;
      const double r = glm::length(way);
      heard[i] = std::polar(array::directivity(array::Directivity::t4010a1, glm::dot(way, t.axis) / r, ka) / r,
                            2 * pi * r / wavelength);
    }
    for (int j = 0; j < foci; ++j) {
      const double r = glm::distance(ring[j], t.position);
      const std::complex<double> q = std::polar(r, -2 * pi * r / wavelength);  // the farthest one's delay is taken off
                                                                               // below
      for (int i = 0; i < places; ++i)
        waves[j][i] += q * heard[i];
    }
  }
  for (int j = 0; j < foci; ++j) {
    const double farthest = array::farthest_of(layout, ring[j]);
    for (int i = 0; i < places; ++i)
      pressure[j][i] = std::norm(waves[j][i]) / (farthest * farthest);
  }
  double felt = 0, variance = 0;
  for (int i = 0; i < places; ++i) {
    double mean = 0, square = 0;
    for (int k = 0; k < foci; ++k) {
      mean += pressure[k][i] / foci;
      square += pressure[k][i] * pressure[k][i] / foci;
    }
    variance += square - mean * mean;
    for (int m = 1; m <= 15; ++m) {
      const double hz = m / (foci * dwell), x = hz / 200;
      std::complex<double> line = 0;
      for (int k = 0; k < foci; ++k) {
        // The integral of e^{-iwt} over slot k, divided by the length of all slots.
        const std::complex<double> end = std::polar(1.0, -2 * pi * hz * dwell * (k + 1)),
                                   begin = std::polar(1.0, -2 * pi * hz * dwell * k);
        line +=
            2 * pressure[3 * k % foci][i] * (end - begin) / (std::complex<double>(0, -2 * pi * hz) * (foci * dwell));
      }
      const double sensitivity = 2 / (x * x + 1 / (x * x));
      felt += sensitivity * sensitivity * std::norm(line) / 2;
    }
  }
  return felt / variance;
}

TEST(ArrayField, TheSameRingIsFeltOtherwiseOnEveryArray) {
  constexpr double radius = 5.5e-3;
  const array::Voice voice = voice_of(circle(radius, 10), 3);
  const double of_spots = felt(spectrum_of(voice, 1.5e-3)).vibration;
  EXPECT_NEAR(of_spots, 0.495, 0.005);
  for (const auto& [name, expected] : {std::pair("paper", 0.523), std::pair("openmpd", 0.662)}) {
    const Layout layout = posed(name);
    const ArrayField field(layout, {});
    const Spectrum spectrum = spectrum_of(voice, 1.5e-3, {.field = &field});
    EXPECT_EQ(spectrum.field, FocusKind::array);
    const double share = felt(spectrum).vibration;
    EXPECT_NEAR(share, summed_share(layout, radius), 1e-3) << name;
    EXPECT_NEAR(share, expected, 0.005) << name;
  }
}

TEST(PathField, HasTheHarmonicsOfTheFociThemselves) {
  for (const char* name : {"autd3", "openmpd-pair"}) {
    const Layout layout = posed(name);
    const ArrayField field(layout, {});
    for (const auto& [count, flat] : {std::pair(5u, 1.0), {10u, 1.0}, {13u, 1.0}, {5u, 0.3}, {10u, 0.5}}) {
      std::vector<Vec3> foci = circle(5e-3, count);
      for (Vec3& focus : foci)
        focus.z *= flat;  // sides of different lengths
      const Harmonics harmonics = PathField(field, foci).harmonics(count);
      for (const std::uint32_t stride : {1u, 3u}) {
        const Felt expected = felt(spectrum_of(voice_of(foci, stride), 1.5e-3, {.field = &field}));
        const Felt found = harmonics.felt(stride, 1.5e-3, 1000);
        EXPECT_NEAR(found.vibration, expected.vibration, 1e-9);
        EXPECT_NEAR(found.flutter, expected.flutter, 1e-9);
      }
    }
  }
}

TEST(PathField, KnowsOtherNumbersOfFociOnItsPath) {
  const Layout layout = posed("openmpd");
  const ArrayField field(layout, {});
  // The polygon of 24 corners is almost a circle, and so are rings with fewer corners.
  const PathField path(field, circle(6e-3, 24));
  for (const std::uint32_t count : {10u, 13u, 17u}) {
    const Felt expected = felt(spectrum_of(voice_of(circle(6e-3, count), 3), 1.5e-3, {.field = &field}));
    const Felt found = path.harmonics(count).felt(3, 1.5e-3, 1000);
    EXPECT_NEAR(found.vibration, expected.vibration, 0.01) << count;
    EXPECT_NEAR(found.flutter, expected.flutter, 0.01) << count;
  }
}

TEST(PathField, FociAtOnePlaceAreNotFelt) {
  const Layout layout = posed("autd3");
  const ArrayField field(layout, {});
  const Harmonics harmonics = PathField(field, std::vector<Vec3>(10, Vec3(1e-3, 0, 0))).harmonics(10);
  EXPECT_EQ(harmonics.felt(3, 1.5e-3, 1000).vibration, 0);
  EXPECT_EQ(harmonics.felt(3, 1.5e-3, 1000).flutter, 0);
}

TEST(Tune, OfAnArrayIsThatOfItsField) {
  const Layout layout = posed("openmpd");
  const ArrayField field(layout, {});
  const std::vector<Vec3> foci = circle(5.5e-3, 10);
  const Ring ring{2 * pi * 5.5e-3, 10, 3, 1e-3};
  TuneOptions options{.most_foci = 10};
  const Tuned spots = tune(ring, options, foci);
  EXPECT_EQ(spots.field, FocusKind::spot);
  EXPECT_TRUE(spots.changed);
  EXPECT_EQ(spots.ring.stride, 1u);
  options.spectrum.field = &field;
  const Tuned tuned = tune(ring, options, foci);
  EXPECT_EQ(tuned.field, FocusKind::array);
  EXPECT_FALSE(tuned.changed) << "needless: this array's focus is wider than that";
  EXPECT_EQ(tuned.ring.stride, 3u);
  array::Voice voice = voice_of(foci, 3);
  voice.dwell_s = 1e-3;
  EXPECT_NEAR(tuned.after.vibration, felt(spectrum_of(voice, 1e-3, options.spectrum)).vibration, 1e-6);
  EXPECT_EQ(tune(ring, options).field, FocusKind::spot) << "without the foci their places are not known";
}

TEST(StrideTuner, FollowsWhatItLearns) {
  const Layout layout = posed("openmpd");
  const ArrayField field(layout, {});
  const std::vector<Vec3> foci = circle(5.5e-3, 10);
  const Ring ring{2 * pi * 5.5e-3, 10, 3, 1e-3};
  const Harmonics harmonics = PathField(field, foci).harmonics(10);
  StrideTuner tuner;
  EXPECT_FALSE(tuner.wants(4, 0)) << "a finger that it has not seen";
  EXPECT_EQ(tuner.stride_for(4, ring, 0), 1u);
  EXPECT_TRUE(tuner.wants(4, 0));
  tuner.learn(4, harmonics, 0);
  tuner.learn(5, harmonics, 0);  // of no finger
  EXPECT_FALSE(tuner.wants(4, 0.4));
  EXPECT_EQ(tuner.stride_for(4, ring, 0.02), 3u) << "at once, though it changed a moment ago";
  EXPECT_TRUE(tuner.wants(4, 0.5));
  EXPECT_EQ(tuner.stride_for(4, ring, 2), 3u);
  tuner.learn(4, PathField(field, circle(5.5e-3, 11)).harmonics(11), 2);
  EXPECT_EQ(tuner.stride_for(4, ring, 3), 3u) << "of other foci than it has";
  EXPECT_EQ(tuner.stride_for(6, ring, 3), 1u) << "each finger by itself";
}

}  // namespace
}  // namespace palpa::acoustics
