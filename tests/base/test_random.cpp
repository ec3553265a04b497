#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/normal.hpp"
#include "base/random.hpp"

namespace palpa {
namespace {

/// The sequence that the generator's authors publish for this seed.
TEST(Random, IsSplitMix64) {
  Random random(1234567);
  for (const std::uint64_t expected :
       {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u, 16408922859458223821u})
    EXPECT_EQ(random.next(), expected);
}

TEST(Random, NormalNumbersAreNormal) {
  Random random(7);
  constexpr int many = 100'000;
  double sum = 0, squares = 0;
  int within_one = 0;
  for (int i = 0; i < many; ++i) {
    const double n = random.normal();
    sum += n;
    squares += n * n;
    within_one += std::abs(n) < 1 ? 1 : 0;
  }
  EXPECT_NEAR(sum / many, 0, 0.012);
  EXPECT_NEAR(squares / many, 1, 0.018);
  EXPECT_NEAR(within_one / double{many}, normal_cdf(1) - normal_cdf(-1), 0.006);
}

TEST(Random, NormalFloatsAreNormalNumbersRounded) {
  Random random(8), again(8);
  for (int i = 0; i < 100'000; ++i)
    ASSERT_EQ(random.normal_float(), static_cast<float>(again.normal())) << i;
  for (double p = 0x1p-54; p < 1; p = p < 0.25 ? 1.001 * p : p + 1e-4)
    ASSERT_EQ(normal_quantile_float(p), static_cast<float>(normal_quantile(p))) << p;
  for (int i = 1; i < 50; ++i) {
    const double near = std::ldexp(1, -i);
    for (const double p : {0.5 - near / 2, 0.5 + near / 2, 1 - near})
      EXPECT_EQ(normal_quantile_float(p), static_cast<float>(normal_quantile(p))) << p;
  }
}

}  // namespace
}  // namespace palpa
