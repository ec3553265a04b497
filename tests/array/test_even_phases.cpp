// Evening out by the phases of transducers alone: how even foci become, and what stays unchanged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "array/layouts/layout.hpp"
#include "array/solvers/even_phases.hpp"
#include "columns.hpp"
#include "focus_sets.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

// From phases that leave some foci almost silent to even foci: no magnitude changes, the weakest becomes far louder.
TEST(EvenPhases, EvenOutWhateverTheAmplitudes) {
  const Layout layout = load_layout("autd3");
  for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
    for (const double radius : {6e-3, 7e-3}) {
      const Columns columns =
          columns_of(layout, ring(10, radius, {0, 0, 0.15}, {1, 0, 0}, {0, 0, 1}), Weighting::distance);
      const std::vector<double> targets(columns.foci, 1);
      const std::vector<Complex> first = sums_of(columns, constraint, 3);
      std::vector<Complex> drive = first;
      PhaseScratch scratch;
      const Evened evened = even_phases(columns, targets, 0.0045, 60, drive, scratch);
      EXPECT_LE(evened.miss, 0.0045);
      EXPECT_LE(evened.tries, 60u);
      const auto before = heard_of(columns, first), after = heard_of(columns, drive);
      EXPECT_LT(*std::ranges::min_element(before), 0.7 * *std::ranges::max_element(before)) << "nothing to improve";
      EXPECT_GE(*std::ranges::min_element(after), 0.99 * *std::ranges::max_element(after));
      EXPECT_GT(*std::ranges::min_element(after), 1.2 * *std::ranges::min_element(before));
      for (std::size_t n = 0; n < drive.size(); ++n)
        ASSERT_NEAR(std::abs(drive[n]), std::abs(first[n]), 1e-12) << n;
    }
  }
}

TEST(EvenPhases, TargetsAreRelativeAndMayBeNone) {
  const Layout layout = load_layout("openmpd");
  const Columns columns = columns_of(layout, focus_set(3, 4, {0, 0, 0.15}), Weighting::distance);
  std::vector<Complex> drive = sums_of(columns, Constraint::uniform, 3);
  drive[7] = 0;  // silent, and remains so
  PhaseScratch scratch;
  even_phases(columns, std::vector<double>{1, 0.5, 0.8, 0.25}, 0.001, 60, drive, scratch);
  const auto heard = heard_of(columns, drive);
  EXPECT_NEAR(heard[1] / heard[0], 0.5, 0.002);
  EXPECT_NEAR(heard[2] / heard[0], 0.8, 0.003);
  EXPECT_NEAR(heard[3] / heard[0], 0.25, 0.001);
  EXPECT_EQ(drive[7], Complex(0));
  const std::vector<Complex> first = drive;
  even_phases(columns, std::vector<double>{0, 0, 0, 0}, 0.001, 60, drive, scratch);
  EXPECT_EQ(drive, first);
}

// Even foci stay the same to the last bit, and with no tries allowed, none is made.
TEST(EvenPhases, EvenFociAreNotChanged) {
  const Layout layout = load_layout("openmpd");
  const Columns columns = columns_of(layout, focus_set(3, 4, {0, 0, 0.15}), Weighting::distance);
  std::vector<Complex> drive = sums_of(columns, Constraint::uniform, 3);
  const std::vector<double> targets(columns.foci, 1);
  const std::vector<Complex> first = drive;
  PhaseScratch scratch;
  EXPECT_EQ(even_phases(columns, targets, 0.001, 0, drive, scratch).tries, 0u);
  EXPECT_EQ(drive, first);
  EXPECT_GT(even_phases(columns, targets, 0.001, 60, drive, scratch).tries, 0u);
  const std::vector<Complex> even = drive;
  EXPECT_EQ(even_phases(columns, targets, 0.001, 60, drive, scratch).tries, 0u);
  EXPECT_EQ(drive, even);
}

}  // namespace
}  // namespace palpa::array
