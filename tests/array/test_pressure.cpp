// The forward model: directivities against formulas and tables, pressures against another program's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "array/pressure.hpp"
#include "csv.hpp"
#include "support/shared_data.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

double at_degrees(Directivity kind, double degrees, double ka = 3.2973) {
  return directivity(kind, std::cos(degrees * pi / 180), ka);
}

TEST(Directivity, OmniIsAlikeAllAround) {
  for (const double degrees : {0.0, 45.0, 90.0, 135.0, 180.0})
    EXPECT_EQ(at_degrees(Directivity::omni, degrees), 1);
}

TEST(Directivity, T4010A1IsTheTableAndMonotoneBetween) {
  const double table[]{1, 1, 1, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778};
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(at_degrees(Directivity::t4010a1, 10 * i), table[i], 1e-12) << i;
  double before = 1;
  for (double degrees = 0; degrees <= 180; degrees += 0.25) {
    const double here = at_degrees(Directivity::t4010a1, degrees);
    EXPECT_LE(here, before + 1e-12) << degrees;
    EXPECT_LE(before - here, 0.006) << degrees;  // no jump anywhere
    before = here;
  }
  EXPECT_NEAR(before, 0, 1e-12);
  // A cubic, no chord: the table's second differences are that large.
  EXPECT_GT(at_degrees(Directivity::t4010a1, 25), 0.955);
}

TEST(Directivity, PistonIsItsSeries) {
  for (const double ka : {0.5, 3.2973, 8.0}) {
    for (double degrees = 0; degrees <= 90; degrees += 5) {
      const double x = ka * std::sin(degrees * pi / 180);
      double sum = 0, term = 1;  // 2 J1(x) / x = sum of (-x^2/4)^m / (m! (m + 1)!)
      for (int m = 0; m < 40; ++m) {
        sum += term;
        term *= -x * x / 4 / ((m + 1.0) * (m + 2.0));
      }
      EXPECT_NEAR(at_degrees(Directivity::piston, degrees, ka), sum, 1e-12) << ka << " " << degrees;
    }
  }
  // Published for a = 4.5 mm at 40 kHz and 343 m/s.
  EXPECT_NEAR(at_degrees(Directivity::piston, 40), 0.534, 1e-3);
  EXPECT_NEAR(at_degrees(Directivity::piston, 90), 0.135, 1e-3);
  EXPECT_NEAR(at_degrees(Directivity::piston, 120), 0.135 / 4, 1e-3);
}

TEST(Directivity, TheSolversTableIsCloseToIt) {
  for (const Directivity kind : {Directivity::omni, Directivity::piston, Directivity::t4010a1}) {
    const std::vector<double> table = directivity_table(kind, 3.3);
    ASSERT_EQ(table.size(), directivity_steps + 1);
    double worst = 0;
    for (int i = 0; i <= 100000; ++i) {
      const double cosine = -1 + 2e-5 * i;
      const double at = (cosine + 1) / 2 * directivity_steps;
      const auto step = std::min<std::size_t>(static_cast<std::size_t>(at), directivity_steps - 1);
      const double looked_up = table[step] + (table[step + 1] - table[step]) * (at - static_cast<double>(step));
      worst = std::max(worst, std::abs(looked_up - directivity(kind, cosine, 3.3)));
    }
    EXPECT_LE(worst, 5e-5) << static_cast<int>(kind);
  }
}

/// A drive and a level of 6 Pa at 1 m, as the reference data has it.
struct Reference {
  Layout layout = load_layout("openmpd");
  Medium medium{343, 40e3};
  Drive drive;
  explicit Reference(const std::vector<std::vector<double>>& positions,
                     const std::vector<std::vector<double>>& phases) {
    layout.source_level_pa_m = 6;
    drive.resize(layout.transducers.size());
    for (std::size_t row = 0; row < positions.size(); ++row) {
      const Vec3 place(positions[row][0], positions[row][1], positions[row][2]);
      for (std::size_t t = 0; t < drive.size(); ++t) {
        if (glm::distance(layout.transducers[t].position, place) < 1e-6)
          drive[t] = {1, static_cast<float>(phases[row][0])};
      }
    }
  }
};

TEST(Pressure, FieldsAreLevitates) {
  PALPA_SHARED_OR_SKIP(folder, "acoustics-levitate");
  const Reference reference(test::read_csv(folder / "array16x16_positions.csv"),
                            test::read_csv(folder / "phases_f0.csv"));
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
      const Complex p =
          pressure_at(reference.layout, reference.drive, {row[0], row[1], row[2]}, reference.medium, kind);
      worst = std::max(worst, std::abs(p - Complex(row[3], row[4])));
    }
    // Phases are floats in a drive.
    EXPECT_LE(worst, focus_pa * 1e-6) << file;
    EXPECT_NEAR(std::abs(pressure_at(reference.layout, reference.drive, {0, 0, 0.15}, reference.medium, kind)),
                focus_pa, 0.01);
    std::printf("  %s: %zu points within %.1e of the focus' pressure\n", file, rows.size(), worst / focus_pa);
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
  // Finite at the transducer: no nearer than its radius.
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
}  // namespace palpa::array
