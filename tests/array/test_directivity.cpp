// Directivities against formulas and tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "array/field/directivity.hpp"

namespace palpa::array {
namespace {

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
  // A cubic instead of a chord: the table's second differences are that large.
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

}  // namespace
}  // namespace palpa::array
