// Raising the weakest focus by the phases of transducers alone: the shares of a step, and what a climb changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "array/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/climb.hpp"
#include "array/solvers/hearing.hpp"
#include "focus_sets.hpp"
#include "loud_sets.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

Columns columns_of(const Layout& layout, const std::vector<SlotFocus>& foci) {
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci)
    sources.push_back({focus.position, 1, 1});
  Columns columns;
  field.fill(sources, Weighting::uniform, columns);
  return columns;
}

std::vector<Complex> sums_of(const Columns& columns) {
  std::vector<Complex> sums(columns.transducers);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    for (std::size_t j = 0; j < columns.foci; ++j)
      sums[n] += columns.ask(n * columns.foci + j);
    sums[n] = bounded(sums[n], Constraint::uniform);
  }
  return sums;
}

std::vector<double> heard_of(const Columns& columns, const std::vector<Complex>& drive) {
  std::vector<double> heard;
  for (std::size_t j = 0; j < columns.foci; ++j) {
    Complex sum = 0;
    for (std::size_t n = 0; n < drive.size(); ++n)
      sum += columns.transfer(n * columns.foci + j) * drive[n];
    heard.push_back(std::abs(sum));
  }
  return heard;
}

// The conditions of an optimum: all foci with a share are at the level, all others above it.
TEST(ShareStep, FindsTheBestCommonLevel) {
  SetRandom random(3);
  for (std::size_t foci = 2; foci <= 12; ++foci) {
    for (const double stiffness : {0.5, 1.0, 20.0}) {
      std::vector<double> rows(foci * 3 * foci), growth(foci * foci), loud(foci), shares(foci);
      for (double& entry : rows)
        entry = random.between(-1, 1);
      for (std::size_t j = 0; j < foci; ++j) {
        for (std::size_t k = 0; k < foci; ++k) {
          for (std::size_t n = 0; n < 3 * foci; ++n)
            growth[j * foci + k] += rows[j * 3 * foci + n] * rows[k * 3 * foci + n];
        }
      }
      for (double& heard : loud)
        heard = random.between(1, 2);
      const std::vector<std::uint8_t> counts(foci, 1);
      ShareScratch scratch;
      const double level = find_shares(growth, loud, counts, stiffness, 0, shares, scratch);
      double sum = 0;
      for (std::size_t j = 0; j < foci; ++j) {
        EXPECT_GE(shares[j], 0);
        sum += shares[j];
        double then = loud[j];
        for (std::size_t k = 0; k < foci; ++k)
          then += growth[j * foci + k] * shares[k] / stiffness;
        if (shares[j] > 0) {
          EXPECT_NEAR(then, level, 2e-3) << foci << " " << stiffness;
        } else {
          EXPECT_GE(then, level - 2e-3) << foci << " " << stiffness;
        }
      }
      EXPECT_NEAR(sum, 1, 1e-9);
      EXPECT_GE(level, *std::ranges::min_element(loud));
    }
  }
}

TEST(ShareStep, LeavesOutFociWithoutATarget) {
  const std::vector<double> growth{1, 0, 0, 1}, loud{1, 0};
  std::vector<double> shares(2);
  ShareScratch scratch;
  find_shares(growth, loud, std::vector<std::uint8_t>{1, 0}, 1, 0, shares, scratch);
  EXPECT_EQ(shares, (std::vector<double>{1, 0}));
}

TEST(Climb, RaisesTheWeakestAndNothingElseChanges) {
  for (const char* name : {"openmpd", "autd3"}) {
    const Layout layout = load_layout(name);
    for (std::uint32_t set = 0; set < 8; ++set) {
      const Columns columns = columns_of(layout, loud_set(set, 2, 10, middle_of(layout)));
      const std::vector<double> targets(columns.foci, 1);
      std::vector<Complex> drive = sums_of(columns);
      drive[7] = 0;     // silent, and remains so
      drive[8] *= 0.5;  // half as loud, and remains so
      const std::vector<Complex> first = drive;
      const auto before = heard_of(columns, first);
      std::vector<double> shares(columns.foci, 1);
      ClimbScratch scratch;
      const double weakest = climb(columns, targets, {10, 30, 0, 1000, 1e-4}, shares, drive, scratch);
      const auto after = heard_of(columns, drive);
      EXPECT_NEAR(weakest, *std::ranges::min_element(after), 1e-6 * weakest);
      EXPECT_GE(weakest, *std::ranges::min_element(before));
      for (std::size_t n = 0; n < drive.size(); ++n)
        ASSERT_NEAR(std::abs(drive[n]), std::abs(first[n]), 1e-12) << n;
      // Lowering costs the weakest next to nothing, and no focus becomes less even.
      std::vector<Complex> lowered = first;
      std::ranges::fill(shares, 1);
      EXPECT_GE(climb(columns, targets, {10, 30, 20, 1000, 1e-4}, shares, lowered, scratch), 0.996 * weakest);
      const auto last = heard_of(columns, lowered);
      EXPECT_LE(*std::ranges::max_element(last), 1.01 * *std::ranges::max_element(after));
    }
  }
}

TEST(Climb, TargetsAreRelativeAndMayBeNone) {
  const Layout layout = load_layout("openmpd");
  const Columns columns = columns_of(layout, focus_set(3, 4, {0, 0, 0.15}));
  std::vector<Complex> drive = sums_of(columns);
  std::vector<double> shares(4, 1);
  ClimbScratch scratch;
  climb(columns, std::vector<double>{1, 0.5, 0.8, 0.25}, {10, 40, 20, 1000, 1e-5}, shares, drive, scratch);
  const auto heard = heard_of(columns, drive);
  EXPECT_NEAR(heard[1] / heard[0], 0.5, 0.01);
  EXPECT_NEAR(heard[2] / heard[0], 0.8, 0.01);
  EXPECT_NEAR(heard[3] / heard[0], 0.25, 0.01);
  const std::vector<Complex> first = drive;
  EXPECT_EQ(climb(columns, std::vector<double>{0, 0, 0, 0}, {10, 40, 20, 1000, 1e-5}, shares, drive, scratch), 0);
  EXPECT_EQ(drive, first);
}

}  // namespace
}  // namespace palpa::array
