// Drives against numbers that others computed, and against the sound that they give.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "backends.hpp"
#include "support/csv.hpp"
#include "support/shared_data.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

class DriveSoundOn : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends, DriveSoundOn, testing::ValuesIn(backends), backend_name);

/// Omnidirectional sources of unit pressure at 1 m, in double precision.
Complex pressure(const Layout& layout, const Drive& drive, const Vec3& at, const Medium& medium = {}) {
  const double k = 2 * std::numbers::pi * medium.turns_per_metre();
  Complex sum = 0;
  for (std::size_t t = 0; t < drive.size(); ++t) {
    const double r = glm::distance(layout.transducers[t].position, at);
    sum += std::polar<double>(drive[t].amplitude / r, drive[t].phase + k * r);
  }
  return sum;
}

TEST_P(DriveSoundOn, OpenmpdAgreesWithLevitate) {
  PALPA_SHARED_OR_SKIP(phase_file, "acoustics-levitate/phases_f0.csv");
  PALPA_SHARED_OR_SKIP(position_file, "acoustics-levitate/array16x16_positions.csv");
  PALPA_SHARED_OR_SKIP(pressure_file, "acoustics-levitate/pressure_point_f0.csv");
  const auto phases = test::read_csv(phase_file);
  const auto positions = test::read_csv(position_file);
  const Layout layout = load_layout("openmpd");
  ASSERT_EQ(phases.size(), layout.transducers.size());
  DriveOptions options;
  options.medium.sound_speed = 343;
  options.weighting = Weighting::uniform;
  const Drive drive = GetParam().drive(layout, {{{0, 0, 0.15}}}, options);

  std::vector<double> differences;
  Complex common = 0;
  for (std::size_t row = 0; row < positions.size(); ++row) {
    const Vec3 place(positions[row][0], positions[row][1], positions[row][2]);
    const auto match = std::ranges::find_if(
        layout.transducers, [&](const Transducer& t) { return glm::distance(t.position, place) < 1e-6; });
    ASSERT_NE(match, layout.transducers.end()) << row;
    const auto t = static_cast<std::size_t>(match - layout.transducers.begin());
    differences.push_back(drive[t].phase - phases[row][0]);
    common += std::polar(1.0, differences.back());
  }
  double worst = 0;
  for (const double difference : differences)
    worst = std::max(worst, angle_between(difference, std::arg(common)));
  EXPECT_LE(worst, 5e-5);
  // There is no common phase either, because both count from the source.
  EXPECT_LE(std::abs(std::arg(common)), 1e-6);
  std::printf("  %s: phases within %.1e rad, common phase %.1e\n", GetParam().name, worst, std::arg(common));

  // The same sound on their grid: 6 Pa at 1 m. meta.json: 9356.079 Pa at the focus.
  double error = 0;
  for (const auto& row : test::read_csv(pressure_file)) {
    const Complex p = 6.0 * pressure(layout, drive, {row[0], row[1], row[2]}, options.medium);
    error = std::max(error, std::abs(p - Complex(row[3], row[4])));
  }
  EXPECT_LE(error, 9356 * 2e-6);
  EXPECT_NEAR(6.0 * std::abs(pressure(layout, drive, {0, 0, 0.15}, options.medium)), 9356.079381, 0.01);
}

TEST_P(DriveSoundOn, EveryTransducerArrivesInPhaseAtTheFocus) {
  for (const std::string& name : layout_names()) {
    const Layout layout = load_layout(name);
    const Vec3 focus(0.012, -0.007, name == "paper" ? 0.004 : 0.15);
    const Drive drive = GetParam().drive(layout, {{focus}});
    double all = 0;
    for (std::size_t t = 0; t < drive.size(); ++t) {
      all += drive[t].amplitude / glm::distance(layout.transducers[t].position, focus);
    }
    EXPECT_NEAR(std::abs(pressure(layout, drive, focus)) / all, 1, 1e-9) << name;
  }
}

/// Climbs from `at`, in steps down to 0.01 mm.
Vec3 peak_near(const Layout& layout, const Drive& drive, Vec3 at) {
  double best = std::abs(pressure(layout, drive, at));
  double step = 2e-3;
  for (int halving = 0; halving < 8; ++halving) {
    step /= 2;
    for (bool moved = true; moved;) {
      moved = false;
      for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        for (const double sign : {-step, step}) {
          const double here = std::abs(pressure(layout, drive, at + sign * way));
          if (here <= best) continue;
          best = here;
          at += sign * way;
          moved = true;
        }
      }
    }
  }
  return at;
}

TEST_P(DriveSoundOn, PressurePeaksAtTheFocusInTheTunnel) {
  const Layout layout = load_layout("paper");
  for (const Vec3& focus : {Vec3(0, 0, 0), Vec3(0.02, -0.01, 0.005), Vec3(-0.03, 0.02, -0.01)}) {
    const Drive drive = GetParam().drive(layout, {{focus}});
    // The nearer walls move the peak by a tenth of a millimetre off the axis.
    EXPECT_LE(glm::distance(peak_near(layout, drive, focus), focus), glm::length(focus) == 0 ? 2e-5 : 3e-4);
  }
}

TEST_P(DriveSoundOn, AFlatArraysPeakLiesNearer) {
  const Layout layout = load_layout("openmpd");
  DriveOptions options;
  options.weighting = Weighting::uniform;
  const Drive drive = GetParam().drive(layout, {{{0, 0, 0.15}}}, options);
  const Vec3 peak = peak_near(layout, drive, {0, 0, 0.15});
  EXPECT_NEAR(peak.x, 0, 2e-5);
  EXPECT_NEAR(peak.y, 0, 2e-5);
  EXPECT_NEAR(peak.z, 0.1457, 2e-4);
}

TEST_P(DriveSoundOn, TwoFociAreTwoPeaks) {
  const Layout layout = load_layout("paper");
  const Vec3 a(0.03, 0, 0);
  const Vec3 b(-0.03, 0.01, 0.01);
  const Drive drive = GetParam().drive(layout, {{a}, {b}});
  const Vec3 between = 0.5 * (a + b);
  for (const Vec3& focus : {a, b}) {
    EXPECT_LE(glm::distance(peak_near(layout, drive, focus), focus), 5e-4);
    EXPECT_GT(std::abs(pressure(layout, drive, focus)), 4 * std::abs(pressure(layout, drive, between)));
  }
  EXPECT_NEAR(std::abs(pressure(layout, drive, a)) / std::abs(pressure(layout, drive, b)), 1, 0.1);
}

}  // namespace
}  // namespace palpa::array
