// `palpa bench --suite growth`, at its smallest sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "bench/growth.hpp"
#include "support/device.hpp"

namespace palpa {
namespace {

TEST(Growth, ExponentsAreThoseOfThePowers) {
  using Samples = std::vector<bench::GrowthSample>;
  const auto linear = bench::exponents_of(Samples{{1, 2}, {10, 20}, {1000, 2000}});
  EXPECT_NEAR(linear.fitted, 1, 1e-12);
  EXPECT_NEAR(linear.steepest, 1, 1e-12);
  const auto bent = bench::exponents_of(Samples{{1, 5}, {10, 5}, {100, 500}});
  EXPECT_NEAR(bent.fitted, 1, 1e-12);
  EXPECT_NEAR(bent.steepest, 2, 1e-12);
  EXPECT_EQ(bench::exponents_of(Samples{{1, 5}}).fitted, 0);
}

TEST(Growth, EachAxisIsMeasuredOnHostAndDeviceAndDrawn) {
  std::vector<bench::Row> rows;
  const bench::Context context{test::test_device(), 3, {}, [](const std::string&, std::uint64_t, std::uint64_t) {}};
  const auto curves = bench::measure_growth(context, 100, rows);
  std::multiset<std::string> found;
  for (const bench::GrowthCurve& curve : curves) {
    found.insert(curve.name + ", " + curve.where);
    EXPECT_EQ(curve.samples.size(), static_cast<std::size_t>(std::ranges::count_if(rows, [&](const bench::Row& row) {
                return row.name == curve.name && row.stage == curve.where;
              })));
    for (const bench::GrowthSample& sample : curve.samples)
      EXPECT_GT(sample.ms, 0);
  }
  // Skin points and transducers begin with more than a hundred.
  EXPECT_EQ(found, (std::multiset<std::string>{"cameras, device", "cameras, host", "faces, device", "faces, host",
                                               "fingers, device", "fingers, host", "foci, device", "foci, host",
                                               "solids, device", "solids, host"}));
  const auto last = std::ranges::find_if(rows, [](const bench::Row& row) { return row.value == 64; });
  ASSERT_NE(last, rows.end());
  EXPECT_NE(last->note.find("exponent"), std::string::npos) << last->note;
  const std::string svg = bench::growth_svg(curves, "a device");
  for (const bench::GrowthCurve& curve : curves)
    EXPECT_NE(svg.find(">" + curve.name + "<"), std::string::npos);
  EXPECT_NE(svg.find("64 fingers: "), std::string::npos);
  EXPECT_NE(svg.find(">exponents<"), std::string::npos) << "in the fields that the five panels leave free";
}

}  // namespace
}  // namespace palpa
