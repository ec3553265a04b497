// Suites of `palpa bench`, at their smallest sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "array/drive_options.hpp"
#include "bench/bench.hpp"
#include "bench/growth.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/device.hpp"
#include "support/shared_data.hpp"

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

TEST(Bench, ARowHasTheMedianThe99thPercentileAndTheLeast) {
  std::vector<double> samples;
  for (int i = 0; i <= 200; ++i)
    samples.push_back(1 + (i * 77 % 201) * 0.5);  // 1 to 101
  const bench::Row row = bench::make_row("suite", "name", "stage", samples);
  EXPECT_EQ(row.median_ms, 51);
  EXPECT_EQ(row.p99_ms, 100);
  EXPECT_EQ(row.least_ms, 1);
  EXPECT_EQ(row.runs, 201u);
  EXPECT_EQ(row.suite + ' ' + row.name + ' ' + row.stage, "suite name stage");
}

const bench::Context& few_runs() {
  static const bench::Context context{
      test::test_device(), 1, {}, [](const std::string&, std::uint64_t, std::uint64_t) {}};
  return context;
}

TEST(Bench, NullsAreMeasuredUnderEveryConstraint) {
  std::vector<bench::Row> rows;
  bench::measure_nulls(few_runs(), rows, 1);
  std::multiset<std::string> found;
  for (const bench::Row& row : rows) {
    found.insert(row.name);
    EXPECT_GT(row.value, 0) << row.name;
  }
  std::multiset<std::string> expected;
  for (const auto& constraint : array::constraint_words) {
    for (const char* nulls : {"paper 4 foci 4 nulls ", "openmpd 4 foci 4 nulls ", "paper 4 foci 4 nulls of 0.5 mm "})
      expected.insert(std::string(nulls) + std::string(constraint.word) + " C++");
  }
  EXPECT_EQ(found, expected);
}

TEST(Bench, PreparingSolidsIsMeasuredWithAndWithoutACacheThatIsRemoved) {
  const std::filesystem::path folder = test::scratch_folder("bench-preparation");
  const char* const known = std::getenv("TMPDIR");
  const std::string before = known != nullptr ? known : "";
  setenv("TMPDIR", folder.c_str(), 1);
  std::vector<bench::Row> rows;
  const geometry::Scene scene{"bench", {{"ball", geometry::icosphere(0.02, 16), {}, {}, {}}}};
  bench::measure_preparation(few_runs(), "ball", scene, rows);
  before.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before.c_str(), 1);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].stage, "prepared");
  EXPECT_EQ(rows[1].stage, "from cache");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(Growth, EachAxisIsMeasuredOnHostAndDevice) {
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
}

}  // namespace
}  // namespace palpa
