// The afferents against TouchSim's own output for the same stimuli, and against each other. TouchSim's stimulus is a
// flat punch that is pressed into the skin and lifted again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "observer/afferents/half_space.hpp"
#include "observer/afferents/response.hpp"

namespace palpa::observer {
namespace {

/// The vertical stress at depth z and distance r from the axis of a flat punch of radius a with a force of 1 N (Sneddon
/// 1946).
double stress_of_punch(double a, double z, double r) {
  const double xi = z / a, rho = r / a, middle = rho * rho + xi * xi - 1;
  const double root = std::sqrt(middle * middle + 4 * xi * xi);
  const double phi = std::atan2(2 * xi, middle), theta = std::atan(1 / xi);
  return (std::sin(phi / 2) / std::sqrt(root) +
          xi * std::sqrt(1 + xi * xi) * std::sin(1.5 * phi - theta) / (root * std::sqrt(root))) /
         (2 * std::numbers::pi * a * a);
}

/// The surface's deflection at distance r from such a punch, relative to that under it.
double reach_of_punch(double a, double r) {
  return r <= a ? 1 : 2 / std::numbers::pi * std::asin(a / r);
}

/// The force of a punch that is pressed in by 1 mm, N.
double force_of_punch(double a) {
  return 2 * a * skin_stiffness;
}

/// The skin at `distance_mm` from the axis of a punch of this radius while its depth follows `indentation_mm`, one
/// value per sample. A negative depth pulls the skin, as in TouchSim. Beyond the punch's rim, the surface's velocity
/// arrives with the delay of a surface wave, in whole samples. The stress at 0.3 mm is not delayed.
SkinMotion under_punch(std::span<const double> indentation_mm, double radius_mm, double distance_mm) {
  const std::size_t samples = indentation_mm.size();
  SkinMotion motion{SiteSignal(1, samples), SiteSignal(1, samples)};
  if (samples < 3) return motion;
  const double stress =
      force_of_punch(radius_mm) * stress_of_punch(radius_mm, depth_mm(AfferentClass::sa1), distance_mm);
  const double reach = reach_of_punch(radius_mm, distance_mm);
  const double wave_s = std::max(0.0, distance_mm - radius_mm) / (1e3 * usual_wave_m_s);
  const auto delay = static_cast<std::size_t>(std::lround(wave_s * afferent_rate_hz));
  for (std::size_t n = 0; n < samples; ++n) {
    motion.stress.at(0, n) = stress * indentation_mm[n];
    if (n < delay) continue;
    const std::size_t middle = std::clamp<std::size_t>(n - delay, 1, samples - 2);
    motion.velocity.at(0, n) = reach * (indentation_mm[middle + 1] - indentation_mm[middle - 1]) / 2 * afferent_rate_hz;
  }
  return motion;
}

using Counts = std::array<int, 17>;

/// Linear ramps of 50 ms at both ends.
std::vector<double> ramped(std::vector<double> depth) {
  constexpr std::size_t ramp = 250;
  for (std::size_t i = 0; i < ramp; ++i) {
    const double share = static_cast<double>(i) / (ramp - 1);
    depth[i] *= share;
    depth[depth.size() - 1 - i] *= share;
  }
  return depth;
}

/// TouchSim's second of a sine: its last sample is at 1 s.
std::vector<double> sine(double hz, double amplitude_mm) {
  std::vector<double> depth(5000);
  for (std::size_t n = 0; n < depth.size(); ++n) {
    const double seconds = static_cast<double>(n) / static_cast<double>(depth.size() - 1);
    depth[n] = amplitude_mm * std::sin(2 * std::numbers::pi * hz * seconds);
  }
  return ramped(depth);
}

std::vector<double> hold(double depth_mm) {
  return ramped(std::vector<double>(5000, depth_mm));
}

Counts counts_of(const SkinMotion& motion) {
  Counts counts{};
  for (std::size_t m = 0; m < counts.size(); ++m)
    counts[m] = static_cast<int>(respond(motion, afferent_models()[m]).counts[0]);
  return counts;
}

struct Row {
  std::string name;
  std::vector<double> depth;
  double radius_mm;
  Counts under, beside;  // at 0 and 3 mm
};

std::vector<Row> rows() {
  return {
      {"10 Hz 0.5 mm",
       sine(10, 0.5),
       0.5,
       {43, 28, 51, 38, 58, 57, 58, 40, 48, 58, 47, 48, 48, 11, 20, 20, 11},
       {5, 0, 0, 0, 0, 0, 0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0}},
      {"10 Hz 0.1 mm", sine(10, 0.1), 0.5, {9, 0, 9, 3, 0, 0, 10, 9, 0, 18, 0, 9, 0, 11, 0, 0, 9}, {}},
      {"50 Hz 0.1 mm",
       sine(50, 0.1),
       0.5,
       {29, 15, 36, 15, 48, 49, 81, 49, 47, 79, 48, 48, 47, 51, 97, 49, 144},
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 49, 23, 0, 48}},
      {"50 Hz 0.02 mm",
       sine(50, 0.02),
       0.5,
       {2, 0, 0, 0, 0, 0, 23, 15, 0, 24, 0, 15, 0, 50, 32, 0, 49},
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 24, 0, 0, 0}},
      {"200 Hz 0.02 mm",
       sine(200, 0.02),
       0.5,
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 48, 0, 0, 0, 200, 391, 190, 386},
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 196, 48, 0, 195}},
      {"200 Hz 0.002 mm",
       sine(200, 0.002),
       0.5,
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 196, 48, 0, 195},
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 48, 0, 0, 0}},
      {"200 Hz 0.0005 mm", sine(200, 0.0005), 0.5, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 95, 0, 0, 47}, {}},
      {"hold 1 mm",
       hold(1),
       0.5,
       {39, 35, 61, 49, 7, 6, 6, 4, 6, 7, 5, 6, 6, 3, 3, 1, 3},
       {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 2, 0, 3}},
      {"hold 1 mm, radius 1 mm",
       hold(1),
       1,
       {22, 13, 32, 24, 7, 6, 6, 4, 6, 7, 5, 6, 6, 3, 3, 1, 3},
       {2, 0, 1, 1, 0, 0, 0, 1, 0, 2, 0, 1, 0, 2, 3, 1, 3}},
      {"hold 0.2 mm",
       hold(0.2),
       0.5,
       {5, 0, 13, 1, 0, 0, 0, 1, 0, 2, 0, 1, 0, 2, 2, 1, 3},
       {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}},
  };
}

TEST(Afferents, SpikeCountsOfTouchSim) {
  for (const Row& row : rows()) {
    for (const double distance : {0.0, 3.0}) {
      const Counts is = counts_of(under_punch(row.depth, row.radius_mm, distance));
      const Counts& expected = distance == 0 ? row.under : row.beside;
      for (std::size_t m = 0; m < is.size(); ++m)
        EXPECT_LE(std::abs(is[m] - expected[m]), 1)
            << row.name << " at " << distance << " mm, model " << m << ": " << is[m] << " for " << expected[m];
    }
  }
}

TEST(Afferents, FirstSpikesOfTouchSim) {
  const auto first = [](const std::vector<double>& depth, std::size_t model) {
    const Spikes spikes = respond(under_punch(depth, 0.5, 0), afferent_models()[model], 1, 0, SpikeTimes::yes);
    return spikes.times[0].empty() ? -1 : spikes.times[0].front();
  };
  EXPECT_NEAR(first(sine(10, 0.5), 0), 0.0130, 2.5e-4);
  EXPECT_NEAR(first(sine(10, 0.5), 9), 0.0390, 2.5e-4);
  EXPECT_NEAR(first(sine(10, 0.5), 13), 0.0008, 2.5e-4);
  EXPECT_NEAR(first(sine(50, 0.02), 0), 0.2876, 2.5e-4);
  EXPECT_NEAR(first(sine(200, 0.002), 13), 0.0052, 2.5e-4);
  EXPECT_NEAR(first(hold(1), 9), 0.0034, 2.5e-4);
  EXPECT_EQ(first(sine(200, 0.02), 0), -1);
}

TEST(Afferents, SignalsOfTouchSim) {
  const std::vector<double> depth = sine(200, 0.02);
  const SkinMotion motion = under_punch(depth, 0.5, 0), beside = under_punch(depth, 0.5, 3);
  double stress = 0, velocity = 0, further = 0;
  for (std::size_t n = 0; n < depth.size(); ++n) {
    stress = std::max(stress, std::abs(motion.stress.at(0, n)));
    velocity = std::max(velocity, std::abs(motion.velocity.at(0, n)));
    further = std::max(further, std::abs(beside.velocity.at(0, n)));
  }
  EXPECT_NEAR(stress, 8.522879214e-4, 1e-12);
  EXPECT_NEAR(velocity * skin_stiffness / 0.09, 16.45096123, 1e-7);
  EXPECT_NEAR(further * skin_stiffness / 0.09, 1.753684938, 1e-8);
  EXPECT_NEAR(further * skin_stiffness / 4, 0.03945791111, 1e-10);
}

TEST(Afferents, SitesBesideEachOtherDoNotMatter) {
  const std::vector<double> depth = sine(50, 0.1);
  const SkinMotion one = under_punch(depth, 0.5, 0);
  SkinMotion six{SiteSignal(6, depth.size()), SiteSignal(6, depth.size())};
  for (std::size_t n = 0; n < depth.size(); ++n) {
    for (const std::size_t site : {1, 5}) {
      six.stress.at(site, n) = one.stress.at(0, n);
      six.velocity.at(site, n) = one.velocity.at(0, n);
    }
  }
  for (const AfferentModel& model : afferent_models()) {
    const Spikes alone = respond(one, model), spikes = respond(six, model);
    for (std::size_t site = 0; site < 6; ++site)
      EXPECT_EQ(spikes.counts[site], site == 1 || site == 5 ? alone.counts[0] : 0) << site;
    // Spikes before a sample are left out, and the level multiplies both signals.
    EXPECT_LT(respond(one, model, 1, 2500).counts[0], std::max(1u, alone.counts[0]));
    EXPECT_EQ(respond(one, model, 0).counts[0], 0u);
  }
}

TEST(Afferents, DeflectionOfADisc) {
  // In um per kPa, for a disc of 2.5 mm.
  const auto um = [](double r) { return deflection_of_disc(2.5, r) * 1e3 * 1e-3; };
  EXPECT_NEAR(um(0), 84.0, 1e-6);
  EXPECT_NEAR(um(1.25), 78.474098, 1e-6);
  EXPECT_NEAR(um(2.5), 53.476061, 1e-6);
  EXPECT_NEAR(um(5), 21.727264, 1e-6);
  // A point force, far away; both branches meet there.
  EXPECT_NEAR(deflection_of_disc(1, 51) / (1 / (51 * skin_stiffness)), 1, 2e-4);
  EXPECT_NEAR(deflection_of_disc(1, 49.999) / deflection_of_disc(1, 50.001), 50.001 / 49.999, 2e-4);
}

}  // namespace
}  // namespace palpa::observer
