// The forward model: pressures against the formula and against another program's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/levitate.hpp"

namespace palpa::acoustics {
namespace {

using namespace array;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

TEST(Pressure, FieldsAreLevitates) {
  PALPA_SHARED_OR_SKIP(folder, "acoustics-levitate");
  Layout layout = load_layout("openmpd");
  layout.source_level_pa_m = 6;
  const Medium medium{343, 40e3};
  Drive drive;
  for (const double phase : levitate_phases(folder, layout))
    drive.push_back({1, static_cast<float>(phase)});
  const struct {
    const char* file;
    Directivity kind;
    double focus_pa;
  } fields[]{{"pressure_point_f0.csv", Directivity::omni, 9356.079381},
             {"pressure_piston_r4.5mm_f0.csv", Directivity::piston, 7524.785336}};
  for (const auto& [file, kind, focus_pa] : fields) {
    double worst = 0;
    const auto rows = test::read_csv(folder / file);
    ASSERT_GT(rows.size(), 1000u);
    for (const auto& row : rows) {
      const Complex p = pressure_at(layout, drive, {row[0], row[1], row[2]}, medium, kind);
      worst = std::max(worst, std::abs(p - Complex(row[3], row[4])));
    }
    // Phases are floats in a drive.
    EXPECT_LE(worst, focus_pa * 1e-6) << file;
    EXPECT_NEAR(std::abs(pressure_at(layout, drive, {0, 0, 0.15}, medium, kind)), focus_pa, 0.01);
  }
}

TEST(Pressure, OneTransducerIsTheFormula) {
  Layout layout;
  const Vec3 axis = glm::normalize(Vec3(2, 3, 4));
  layout.transducers.push_back({{0.01, 0.12, -0.025}, axis});
  layout.source_level_pa_m = 6;
  const Drive drive{{0.5F, 1.25F}};
  const Medium medium{343, 40e3};
  for (const Vec3& point : {Vec3(0.1, 0.2, 0.3), Vec3(-0.15, 1.27, 0.001), Vec3(0, 0, -0.4)}) {
    const Vec3 way = point - layout.transducers[0].position;
    const double r = std::sqrt(glm::dot(way, way));
    const double k = 2 * pi * 40e3 / 343;
    const double angle = std::acos(glm::dot(way, axis) / r);
    double falls_to = 2 * std::cyl_bessel_j(1, k * 4.5e-3 * std::sin(angle)) / (k * 4.5e-3 * std::sin(angle));
    if (angle > pi / 2) {
      falls_to = 2 * std::cyl_bessel_j(1, k * 4.5e-3) / (k * 4.5e-3) * std::pow(1 + std::cos(angle), 2);
    }
    const Complex expected = 6 * 0.5 * falls_to / r * std::exp(Complex(0, 1.25 + k * r));
    EXPECT_LE(std::abs(pressure_at(layout, drive, point, medium, Directivity::piston) - expected),
              1e-9 * std::abs(expected) + 1e-12);
  }
  // It is finite at the transducer: a distance counts as at least the radius.
  EXPECT_NEAR(std::abs(pressure_at(layout, drive, layout.transducers[0].position, medium)), 6 * 0.5 / 4.5e-3, 1e-9);
}

TEST(Pressure, FociAreCounted) {
  const Layout layout = load_layout("openmpd");
  const std::vector<SlotFocus> foci{{{0, 0, 0.15}, 1}, {{0.03, 0, 0.15}, 0.5F}, {{NAN, 0, 0}, 1}, {{0, 0.02, 0.1}, 0}};
  const Drive drive = drive_for(layout, foci);
  const FociPressure heard = pressure_at_foci(layout, drive, foci);
  ASSERT_EQ(heard.pascals.size(), 4u);
  EXPECT_NEAR(heard.pascals[0], std::abs(pressure_at(layout, drive, foci[0].position)), 1e-9);
  EXPECT_EQ(heard.pascals[2], 0);
  EXPECT_NEAR(heard.mean, (heard.pascals[0] + heard.pascals[1]) / 2, 1e-9);
  const double a = heard.pascals[0], b = heard.pascals[1] / 0.5;
  EXPECT_NEAR(heard.evenness, std::min(a, b) / std::max(a, b), 1e-9);
  EXPECT_EQ(pressure_at_foci(layout, drive, {}).evenness, 1);
}

}  // namespace
}  // namespace palpa::acoustics
