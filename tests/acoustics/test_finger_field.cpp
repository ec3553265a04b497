// What a finger feels of foci that move on it, against the sphere's exact series, which this file sums.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "acoustics/bodies/finger_field.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/felt/skin.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "acoustics/field/array_field.hpp"
#include "acoustics/rigs.hpp"
#include "array/focus_sets.hpp"
#include "geometry/mesh/icosphere.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double radius = ball_radius;
constexpr double pi = std::numbers::pi;

/// Point sources at different distances.
const array::Layout& around() {
  static const array::Layout layout = [] {
    array::Layout made = shell(30, 0.15, 0.002);
    made.transducer_radius_m = 0;
    made.source_level_pa_m = 2;
    return made;
  }();
  return layout;
}

/// A ring around the ball's lowest part, inside it.
std::vector<Vec3> ring(int count) {
  std::vector<Vec3> foci;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * pi * i / count;
    foci.emplace_back(5e-3 * std::cos(angle), -6e-3, 5e-3 * std::sin(angle));
  }
  return foci;
}

/// The sum over sources of the sphere's response to each, with its slopes along the surface.
class Exact {
 public:
  Exact() {
    for (const array::Transducer& t : around().transducers)
      series_.push_back(SphereSeries::point_source(still_air().wave_number(), radius, t.position));
  }

  /// For each source at full amplitude, the pressure on the skin over a place.
  std::vector<Complex> transfer(const Vec3& place) const {
    std::vector<Complex> sound;
    for (const SphereSeries& series : series_)
      sound.push_back(around().source_level_pa_m * series.at(radius * glm::normalize(place)));
    return sound;
  }

  /// (|p|^2 - |slope|^2 / k^2) / (4 rho c^2) for these strengths.
  double langevin(std::span<const Complex> strengths, const Vec3& place) const {
    const Vec3 normal = glm::normalize(place);
    const Vec3 s = glm::normalize(glm::cross(normal, Vec3(0.3, 0.4, 0.5))), t = glm::cross(normal, s);
    constexpr double step = 1e-5;
    const auto sum = [&](const Vec3& at) {
      const std::vector<Complex> sound = transfer(at);
      Complex p = 0;
      for (std::size_t i = 0; i < sound.size(); ++i)
        p += strengths[i] * sound[i];
      return p;
    };
    const Vec3 at = radius * normal;
    double slope2 = 0;
    for (const Vec3& way : {s, t})
      slope2 += std::norm((sum(at + step * way) - sum(at - step * way)) / (2 * step));
    const double k = still_air().wave_number();
    const double rho = still_air().density_kg_m3, c = still_air().medium.sound_speed;
    return (std::norm(sum(at)) - slope2 / (k * k)) / (4 * rho * c * c);
  }

 private:
  std::vector<SphereSeries> series_;
};

/// What a focus asks of each source: amplitude in proportion to the distance and the delay of the way; or, for this
/// ball, from the arriving sound.
std::vector<Complex> asked(const Exact& exact, const Vec3& focus, bool for_finger) {
  const double farthest = array::farthest_of(around(), focus);
  const std::vector<Complex> sound = exact.transfer(focus);
  std::vector<Complex> strengths;
  for (std::size_t i = 0; i < sound.size(); ++i) {
    const double d = glm::distance(around().transducers[i].position, focus);
    const double phase = for_finger ? -std::arg(sound[i]) : -still_air().wave_number() * d;
    strengths.push_back(std::polar(d / farthest, phase));
  }
  return strengths;
}

struct Focused {
  bool for_finger;
  FingerTransfer* transfer;
};

TEST(FingerField, IsTheSphereSeriesInFull) {
  const Exact exact;
  FingerTransfer transfer(ball(), around(), still_air(), array::Directivity::omni);
  const std::vector<Vec3> foci = ring(5);
  const std::vector<Vec3> path = path_through(foci, 3);
  for (const Focused way : {Focused{false, nullptr}, Focused{true, &transfer}}) {
    const FingerField field(ball(), around(), still_air(), {.directivity = array::Directivity::omni}, way.transfer);
    std::vector<double> pressures;
    ASSERT_TRUE(field.felt(path, 3, pressures));
    ASSERT_EQ(pressures.size(), foci.size() * path.size());
    Deviation off;
    for (std::size_t focus = 0; focus < foci.size(); ++focus) {
      const std::vector<Complex> strengths = asked(exact, foci[focus], way.for_finger);
      for (std::size_t place = 0; place < path.size(); ++place)
        off.add(pressures[focus * path.size() + place], exact.langevin(strengths, path[place]));
    }
    EXPECT_LE(off.relative(), 0.025);
    std::printf("  %.2f %% off the series\n", 100 * off.relative());
  }
  const FingerField field(ball(), around(), still_air(), {});
  EXPECT_EQ(field.kind(), FocusKind::finger);
  EXPECT_NEAR(glm::length(field.skin_at(foci[1])), radius, 1e-4);
  EXPECT_NEAR(field.step_m(), 343.2 / 40e3 / 6, 1e-6);
  const std::atomic<bool> give_up = true;
  std::vector<double> pressures;
  EXPECT_FALSE(field.felt(path, 3, pressures, &give_up));
}

TEST(FingerField, IsWhatASpectrumOfTheFingerIsMadeOf) {
  const Exact exact;
  const FingerField field(ball(), around(), still_air(), {.directivity = array::Directivity::omni});
  array::Voice voice;
  voice.foci = ring(5);
  voice.order = {0, 2, 4, 1, 3};
  voice.dwell_s = 2e-3;
  const Spectrum spectrum = spectrum_of(voice, voice.dwell_s, {.field = &field});
  EXPECT_EQ(spectrum.field, FocusKind::finger);
  EXPECT_NEAR(glm::length(spectrum.skin), radius, 1e-4);
  ASSERT_EQ(spectrum.lines.size(), 10u);
  // The first focus' own place, computed here.
  std::vector<double> played;
  for (const std::uint32_t focus : voice.order)
    played.push_back(exact.langevin(asked(exact, voice.foci[focus], false), voice.foci[0]));
  double mean = 0;
  for (const double p : played)
    mean += p / 5;
  for (std::size_t m = 1; m <= 10; ++m) {
    Complex c = 0;
    const double x = static_cast<double>(m) / 5;
    for (std::size_t k = 0; k < 5; ++k)
      c += 2 * played[k] / 5 / mean * std::polar(1.0, -2 * pi * x * (static_cast<double>(k) + 0.5));
    const Line& line = spectrum.lines[m - 1];
    EXPECT_NEAR(line.frequency_hz, 100.0 * static_cast<double>(m), 1e-6);
    EXPECT_NEAR(line.amplitude, std::abs(c * std::sin(pi * x) / (pi * x)), 0.03) << m;
  }
  // It differs from the same array's result in free air.
  const ArrayField free(around(), {.directivity = array::Directivity::omni});
  const double apart = felt(spectrum).vibration - felt(spectrum_of(voice, 2e-3, {.field = &free})).vibration;
  EXPECT_GT(std::abs(apart), 0.01);
}

TEST(FingerField, FociThatAskForAPressureHaveIt) {
  FingerTransfer transfer(ball(), around(), still_air(), array::Directivity::omni);
  const std::vector<Vec3> foci = ring(5);
  const array::DriveOptions drive{.directivity = array::Directivity::omni};
  std::vector<double> twice, once;
  ASSERT_TRUE(FingerField(ball(), around(), still_air(), drive, &transfer, 40).felt(foci, 1, twice));
  ASSERT_TRUE(FingerField(ball(), around(), still_air(), drive, &transfer, 20).felt(foci, 1, once));
  for (std::size_t i = 0; i < twice.size(); ++i)
    EXPECT_NEAR(twice[i], 4 * once[i], 1e-3 * twice[0]);
}

}  // namespace
}  // namespace palpa::acoustics
