// Spectra against direct integration of the simulated pressure and against published ratios, and what skin feels of
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include "acoustics/felt/skin.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "base/error.hpp"
#include "support/thrown.hpp"

namespace palpa::acoustics {
namespace {

using namespace array;
constexpr double pi = std::numbers::pi;

double gaussian(double distance, double fwhm = 3.8e-3) {
  return std::pow(2.0, -4 * distance * distance / (fwhm * fwhm));
}

/// A ring of N foci of the given perimeter, measured along the circle.
Voice circle(double perimeter, std::uint32_t foci = 10, std::uint32_t stride = 3) {
  Voice voice;
  const double radius = perimeter / (2 * pi);
  for (std::uint32_t n = 0; n < foci; ++n)
    voice.foci.emplace_back(0.1 + radius * std::cos(2 * pi * n / foci), -0.2, radius * std::sin(2 * pi * n / foci));
  voice.order = fill_order(foci, stride);
  return voice;
}

const Line& line_at(const Spectrum& spectrum, double hz) {
  for (const Line& line : spectrum.lines) {
    if (std::abs(line.frequency_hz - hz) < 1e-6 * hz) return line;
  }
  ADD_FAILURE() << "no line at " << hz << " Hz";
  static const Line none;
  return none;
}

/// 2/T times the integral of the slots' pressures times e^{-2 pi i f t}, by the midpoint rule in fine steps.
std::complex<double> integrated(const std::vector<double>& slots, double slot_s, double hz) {
  constexpr int fine = 400;
  std::complex<double> sum = 0;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    for (int i = 0; i < fine; ++i) {
      const double t = (static_cast<double>(s) + (i + 0.5) / fine) * slot_s;
      sum += slots[s] * std::polar(1.0 / fine, -2 * pi * hz * t);
    }
  }
  return 2.0 * sum / static_cast<double>(slots.size());
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<double> pressures(const Voice& voice, double slot_s, const Vec3& skin, std::size_t count) {
  Schedule schedule;
  schedule.slot_s = slot_s;
  schedule.add_voice() = voice;
  std::vector<double> out;
  std::vector<SlotFocus> foci;
  for (std::size_t slot = 0; slot < count; ++slot) {
    foci_of_slot(schedule, slot, foci);
    double p = 0;
    for (const SlotFocus& focus : foci)
      p += double{focus.gain} * focus.gain * gaussian(glm::distance(focus.position, skin));
    out.push_back(p);
  }
  return out;
}

/// Every line's amplitude and phase at the spectrum's skin point against the integral over `count` slots.
void expect_integrals(const Voice& voice, double slot_s, std::size_t count, double tolerance = 2e-5) {
  const Spectrum spectrum = spectrum_of(voice, slot_s);
  const std::vector<double> p = pressures(voice, slot_s, spectrum.skin, count);
  ASSERT_FALSE(spectrum.lines.empty());
  for (const Line& line : spectrum.lines) {
    const std::complex<double> expected = integrated(p, slot_s, line.frequency_hz) / mean_of(p);
    EXPECT_NEAR(std::abs(std::polar(line.amplitude, line.phase_rad) - expected), 0, tolerance)
        << line.frequency_hz << " Hz: " << line.amplitude << " or " << std::abs(expected);
  }
}

TEST(Spectrum, HasTheRatiosOfTheAnalysisOfTheOrder) {
  // facts: N = 10, s = 3, 1.5 ms, FWHM 3.8 mm along the perimeter, without the hold of the dwell.
  const auto ratio = [](double perimeter, double hz) {
    const Spectrum spectrum = spectrum_of(Ring{perimeter, 10, 3, 1.5e-3});
    const Line &line = line_at(spectrum, hz), &best = line_at(spectrum, 200);
    return line.around / line.hold / (best.around / best.hold);
  };
  EXPECT_NEAR(ratio(15e-3, 800 / 3.0), 0.50, 0.005);
  EXPECT_NEAR(ratio(15e-3, 200 / 3.0), 0.16, 0.005);
  EXPECT_NEAR(ratio(50e-3, 800 / 3.0), 0.96, 0.005);
  EXPECT_NEAR(ratio(50e-3, 200 / 3.0), 0.91, 0.005);
}

TEST(Spectrum, LinesOfTheRingAreThoseOfItsSimulation) {
  for (const double perimeter : {4e-3, 15e-3, 50e-3}) {
    const Ring ring{perimeter, 10, 3, 1.5e-3};
    const Spectrum spectrum = spectrum_of(ring);
    EXPECT_DOUBLE_EQ(spectrum.period_s, 15e-3);
    ASSERT_EQ(spectrum.lines.size(), 15u);
    // The focus at place `order[k]` of ten, the skin at place `x`; both ways round and once more.
    const auto at = [&](double x) {
      std::vector<double> p;
      for (const std::uint32_t n : fill_order(10, 3)) {
        double sum = 0;
        for (int turn = -20; turn <= 20; ++turn)
          sum += gaussian(perimeter * ((x - n) / 10 + turn));
        p.push_back(sum);
      }
      return p;
    };
    double mean = 0;
    std::vector<double> square(spectrum.lines.size());
    constexpr int points = 8;
    for (int i = 0; i < points; ++i) {
      const std::vector<double> p = at(i / double{points});
      mean += mean_of(p) / points;
      for (std::size_t m = 0; m < square.size(); ++m)
        square[m] += std::norm(integrated(p, 1.5e-3, spectrum.lines[m].frequency_hz)) / points;
    }
    const std::vector<double> first = at(0);
    for (std::size_t m = 0; m < square.size(); ++m) {
      const Line& line = spectrum.lines[m];
      EXPECT_NEAR(line.frequency_hz, (m + 1) / 15e-3, 1e-9);
      EXPECT_NEAR(line.around, std::sqrt(square[m]) / mean, 2e-5);
      const auto expected = integrated(first, 1.5e-3, line.frequency_hz) / mean_of(first);
      EXPECT_NEAR(std::abs(std::polar(line.amplitude, line.phase_rad) - expected), 0, 2e-5);
    }
  }
}

TEST(Spectrum, OfAVoiceIsThatOfItsSlots) {
  expect_integrals(circle(15e-3), 1.5e-3, 10);
  expect_integrals(circle(50e-3, 23, 8), 1.5e-3, 23);
  expect_integrals(circle(30e-3, 7, 2), 0.5e-3, 21);
  Voice slow = circle(30e-3);
  slow.dwell_s = 4e-3;  // 2 2/3 slots: it plays for 2 or 3
  expect_integrals(slow, 1.5e-3, 80);
}

Voice still(double hz, Modulation modulation) {
  Voice voice;
  voice.foci = {Vec3(0.01, 0.02, 0.03)};
  voice.order = {0};
  voice.modulation_hz = hz;
  voice.modulation = modulation;
  return voice;
}

TEST(Spectrum, OfAModulationIsThatOfItsSlots) {
  for (const Modulation modulation : {Modulation::pressure_sine, Modulation::amplitude_sine}) {
    expect_integrals(still(200, modulation), 1.5e-3, 10);
    expect_integrals(still(200, modulation), 0.25e-3, 20);
    expect_integrals(still(130, modulation), 1.5e-3, 200);
    expect_integrals(still(500, modulation), 1.5e-3, 4);
    // Its second harmonic falls on the image of its first.
    expect_integrals(still(250, modulation), 4e-3 / 3, 3);
    Voice several = circle(20e-3);
    several.foci_per_slot = 10;
    several.modulation_hz = 200;
    several.modulation = modulation;
    expect_integrals(several, 1.5e-3, 10);
  }
}

TEST(Spectrum, NothingChangesNothingIsFelt) {
  EXPECT_TRUE(spectrum_of(still(0, Modulation::pressure_sine), 1.5e-3).lines.empty());
  EXPECT_EQ(felt(spectrum_of(still(0, Modulation::pressure_sine), 1.5e-3)).vibration, 0);
  // Sampled once per period, a sine is a constant.
  const Spectrum aliased = spectrum_of(still(500, Modulation::pressure_sine), 2e-3);
  EXPECT_NEAR(aliased.variance, 0, 1e-12);
  EXPECT_EQ(spectrum_of(Ring{}).lines.size(), 0u);
  EXPECT_EQ(spectrum_of(Voice{}, 1.5e-3).lines.size(), 0u);
  // All foci at one place: they take turns, but nothing moves.
  const Spectrum same = spectrum_of(circle(0), 1.5e-3);
  EXPECT_NEAR(same.variance, 0, 1e-12);
  EXPECT_EQ(felt(same).vibration, 0);
}

TEST(Spectrum, LinesAddUpToTheVariance) {
  SpectrumOptions all;
  all.highest_hz = 2e5;
  const auto energy = [](const Spectrum& spectrum) {
    double sum = 0;
    for (const Line& line : spectrum.lines)
      sum += line.around * line.around / 2;
    return sum;
  };
  const Spectrum ring = spectrum_of(Ring{20e-3, 10, 3, 1.5e-3}, all);
  EXPECT_NEAR(energy(ring), ring.variance, 2e-3 * ring.variance);
  const Spectrum voice = spectrum_of(circle(20e-3), 1.5e-3, all);
  EXPECT_NEAR(energy(voice), voice.variance, 2e-3 * voice.variance);
  for (const Modulation modulation : {Modulation::pressure_sine, Modulation::amplitude_sine}) {
    for (const double hz : {200.0, 130.0, 2000 / 9.0}) {
      const Spectrum one = spectrum_of(still(hz, modulation), 1.5e-3, all);
      EXPECT_NEAR(energy(one), one.variance, 2e-3 * one.variance) << hz;
    }
  }
}

TEST(Spectrum, RefusesWhatDoesNotRepeat) {
  Voice voice = circle(20e-3);
  voice.dwell_s = 1.2345e-3;
  EXPECT_ERROR(spectrum_of(voice, 1e-3), Exit::usage, "slots of 1 ms does not repeat");
}

TEST(Vibration, IsBestAt200AndFallsBy12DecibelsPerOctave) {
  EXPECT_EQ(vibration_sensitivity(200), 1);
  EXPECT_EQ(vibration_sensitivity(0), 0);
  EXPECT_EQ(vibration_sensitivity(-5), 0);
  for (double hz = 1; hz < 1000; hz *= 1.1) {
    EXPECT_LE(vibration_sensitivity(hz), 1);
    EXPECT_NEAR(vibration_sensitivity(hz), vibration_sensitivity(40000 / hz), 1e-12);
  }
  const auto decibel = [](double hz) { return 20 * std::log10(vibration_sensitivity(hz)); };
  EXPECT_GT(decibel(151), -1.5);
  EXPECT_GT(decibel(265), -1.5);
  EXPECT_LT(decibel(149), -1.4);
  EXPECT_NEAR(decibel(40) - decibel(20), 12, 0.05);
}

TEST(Flutter, IsFeltFrom5To50Hertz) {
  EXPECT_EQ(flutter_sensitivity(0), 0);
  EXPECT_EQ(flutter_sensitivity(-5), 0);
  const auto decibel = [](double hz) { return 20 * std::log10(flutter_sensitivity(hz)); };
  EXPECT_NEAR(decibel(5), -3, 0.02);
  EXPECT_NEAR(decibel(50), -3, 0.02);
  for (const double hz : {10.0, 16.0, 29.0})
    EXPECT_GT(decibel(hz), -0.5) << hz;
  EXPECT_NEAR(decibel(400) - decibel(800), 12, 0.1);
  EXPECT_NEAR(decibel(1) - decibel(0.5), 12, 0.1);
  EXPECT_LT(flutter_sensitivity(200), 0.07);
}

TEST(Felt, IsOneBandOrTheOther) {
  const auto sine = [](double hz) { return spectrum_of(still(hz, Modulation::pressure_sine), 1e-5); };
  const Felt buzz = felt(sine(200)), throb = felt(sine(20));
  EXPECT_NEAR(buzz.vibration, 1, 1e-4);
  EXPECT_LT(buzz.flutter, 0.01);
  EXPECT_LT(throb.vibration, 0.01);
  EXPECT_GT(throb.flutter, 0.95);
  EXPECT_GT(balance(buzz), 0.99);
  EXPECT_NEAR(balance(throb), throb.vibration - flutter_weight * throb.flutter, 1e-15);
  EXPECT_NEAR(felt(sine(100)).vibration, std::pow(vibration_sensitivity(100), 2), 1e-4);
  EXPECT_EQ(strongest_felt(sine(200)), 0u);
  EXPECT_EQ(strongest_felt(Spectrum{}), 0u);
  const Spectrum papers = spectrum_of(Ring{15e-3, 10, 3, 1.5e-3});
  EXPECT_NEAR(papers.lines[strongest_felt(papers)].frequency_hz, 200, 1e-6);
}

}  // namespace
}  // namespace palpa::acoustics
