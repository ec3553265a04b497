// Distribution functions against values of scipy and of published tables.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/normal.hpp"
#include "study/statistics/proportions.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {
namespace {

void expect_relative(double value, double wanted, double tolerance = 2e-9) {
  EXPECT_NEAR(value / wanted, 1, tolerance) << value << " instead of " << wanted;
}

TEST(Distributions, Normal) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-13);
  EXPECT_EQ(normal_quantile(0.5), 0);
  for (const double p : {1e-300, 1e-12, 0.001, 0.2, 0.4999, 0.7, 0.999999})
    expect_relative(normal_cdf(normal_quantile(p)), p, 1e-12);
  EXPECT_NEAR(normal_two_sided(-1.959963984540054), 0.05, 1e-14);
}

TEST(Distributions, StudentsT) {
  // Closed forms for one and two degrees.
  expect_relative(t_critical(0.025, 1), std::tan(0.475 * std::numbers::pi), 1e-11);
  expect_relative(t_critical(0.025, 2), std::sqrt(2 / (0.05 * 1.95) - 2), 1e-11);
  EXPECT_NEAR(t_critical(0.025, 9), 2.26215716, 1e-8);
  for (const double degrees : {1.0, 9.0, 99.0})
    expect_relative(t_two_sided(t_critical(0.025, degrees), degrees), 0.05, 1e-11);
}

TEST(Distributions, ChiSquare) {
  expect_relative(chi_square_tail(54.17785876, 1), 1.831388728e-13, 1e-8);
  expect_relative(chi_square_tail(3.841458820694124, 1), 0.05);
  EXPECT_EQ(chi_square_tail(5, 0), 1);
  EXPECT_EQ(chi_square_tail(0, 3), 1);
}

struct ProportionCase {
  std::uint64_t k, n;
  double exact_low, exact_high, tail;
};
constexpr ProportionCase proportion_cases[]{
    {156, 400, 0.3419209849, 0.4397193331, 4.903515775e-10},
    {261, 400, 0.6035898773, 0.6991342556, 2.533545129e-64},
    {26, 100, 0.1773944379, 0.3573120631, 0.4465291762},
    {74, 100, 0.6426879369, 0.8226055621, 1.250100861e-24},
    {0, 10, 0, 0.3084971078, 1},
    {10, 10, 0.6915028922, 1, 9.536743164e-07},
    {7, 10, 0.3475471499, 0.9332604888, 0.003505706787},
};

TEST(Distributions, Proportions) {
  for (const ProportionCase& c : proportion_cases) {
    SCOPED_TRACE(c.k);
    const Interval exact = clopper_pearson(c.k, c.n);
    EXPECT_NEAR(exact.low, c.exact_low, 1e-10);
    EXPECT_NEAR(exact.high, c.exact_high, 1e-10);
    expect_relative(binomial_tail(c.k, c.n, 0.25), c.tail);
  }
}

}  // namespace
}  // namespace palpa::study
