// Raising the weakest focus by the phases of transducers alone: the shares of a step, and what a climb changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "array/layouts/layout.hpp"
#include "array/solvers/climb.hpp"
#include "columns.hpp"
#include "loud_sets.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

LaneDrives lanes_of(const std::vector<Complex>& drive) {
  LaneDrives lanes;
  const std::size_t size = (drive.size() + lanes_together - 1) / lanes_together * lanes_together;
  lanes.re.resize(size);
  lanes.im.resize(size);
  for (std::size_t n = 0; n < drive.size(); ++n) {
    lanes.re[n] = static_cast<float>(drive[n].real());
    lanes.im[n] = static_cast<float>(drive[n].imag());
  }
  return lanes;
}

/// Changes `drive` and `shares`; returns the weakest focus.
double climb_all(const Columns& columns, const std::vector<double>& targets, const ClimbEffort& effort,
                 std::vector<double>& shares, std::vector<Complex>& drive) {
  LaneColumns lanes;
  take_lanes(columns, columns.transducers, lanes);
  LaneDrives moved = lanes_of(drive);
  ClimbScratch scratch;
  const double weakest = climb(lanes, targets, effort, shares, moved, scratch);
  for (std::size_t n = 0; n < drive.size(); ++n)
    drive[n] = {static_cast<double>(moved.re[n]), static_cast<double>(moved.im[n])};
  return weakest;
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
      const Columns columns = columns_of(layout, loud_set(set, 2, 10, middle_of(layout)), Weighting::uniform);
      const std::vector<double> targets(columns.foci, 1);
      std::vector<Complex> drive = sums_of(columns, Constraint::uniform);
      drive[7] = 0;     // silent, and remains so
      drive[8] *= 0.5;  // half as loud, and remains so
      const std::vector<Complex> first = drive;
      const auto before = heard_of(columns, first);
      std::vector<double> shares(columns.foci, 1);
      const double weakest = climb_all(columns, targets, {10, 30, 0, 1000, 1e-4}, shares, drive);
      const auto after = heard_of(columns, drive);
      EXPECT_NEAR(weakest, *std::ranges::min_element(after), 1e-6 * weakest);
      EXPECT_GE(weakest, *std::ranges::min_element(before));
      for (std::size_t n = 0; n < drive.size(); ++n)
        ASSERT_NEAR(std::abs(drive[n]), std::abs(first[n]), 1e-5) << n;
      // Lowering costs the weakest next to nothing, and no focus becomes less even.
      std::vector<Complex> lowered = first;
      std::ranges::fill(shares, 1);
      EXPECT_GE(climb_all(columns, targets, {10, 30, 20, 1000, 1e-4}, shares, lowered), 0.996 * weakest);
      const auto last = heard_of(columns, lowered);
      EXPECT_LE(*std::ranges::max_element(last), 1.01 * *std::ranges::max_element(after));
    }
  }
}

/// The drive for some of the foci is that for all of them, with targets of 0 for the others.
TEST(Climb, IgnoresFociWithoutATarget) {
  const Layout layout = load_layout("openmpd");
  const std::vector<SlotFocus> foci = loud_set(1, 5, 5, middle_of(layout));
  const auto climbed = [&](const std::vector<SlotFocus>& all, std::vector<double> targets) {
    const Columns columns = columns_of(layout, all, Weighting::uniform);
    const Columns asked = columns_of(layout, {foci.begin() + 1, foci.end() - 1}, Weighting::uniform);
    std::vector<Complex> drive = sums_of(asked, Constraint::uniform);
    std::vector<double> shares(all.size(), 1);
    return climb_all(columns, targets, {10, 30, 20, 1000, 1e-4}, shares, drive);
  };
  const double weakest = climbed({foci.begin() + 1, foci.end() - 1}, {1, 1, 1});
  EXPECT_GT(weakest, 0);
  EXPECT_NEAR(climbed(foci, {0, 1, 1, 1, 0}), weakest, 1e-5 * weakest);
}

/// Against the formulas of climb.hpp, in double precision.
TEST(Climb, APassTurnsEachTransducerAsFarAsItsStiffnessLets) {
  const Layout layout = load_layout("autd3");
  const Columns columns = columns_of(layout, loud_set(2, 4, 4, middle_of(layout)), Weighting::uniform);
  const std::vector<Complex> drive = sums_of(columns, Constraint::uniform);
  const std::size_t foci = columns.foci;
  SetRandom random(5);
  std::vector<Complex> pull(foci), stiff(foci), turn(foci), pressure(foci), expected(foci);
  for (auto* factors : {&pull, &stiff, &turn}) {
    for (Complex& factor : *factors)
      factor = {random.between(-1, 1), random.between(-1, 1)};
  }
  LaneColumns lanes;
  take_lanes(columns, columns.transducers, lanes);
  const LaneDrives lane_drive = lanes_of(drive);
  LaneDrives tried;
  constexpr double soft = 0.2, stiffness = 2, most_turn = 0.3;
  turn_lanes(lanes, lane_drive, pull, {stiff, soft}, stiffness, most_turn, tried, pressure);
  std::vector<double> growth(foci * foci), by_hand(foci * foci);
  find_growth(lanes, lane_drive, turn, {stiff, soft}, 1, growth);
  for (std::size_t n = 0; n < drive.size(); ++n) {
    const auto heard = [&](std::size_t j) { return columns.transfer(n * foci + j) * drive[n]; };
    Complex pulled = 0, held = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      pulled += pull[j] * heard(j);
      held += stiff[j] * heard(j);
    }
    const double by = std::clamp(-pulled.imag() / (stiffness * (std::abs(held) + soft)), -most_turn, most_turn);
    const Complex turned = drive[n] * std::polar(1.0, by);
    ASSERT_NEAR(std::abs(Complex(tried.re[n], tried.im[n]) - turned), 0, 1e-5) << n;
    for (std::size_t j = 0; j < foci; ++j) {
      expected[j] += columns.transfer(n * foci + j) * turned;
      for (std::size_t k = 0; k < foci; ++k)
        by_hand[j * foci + k] += (turn[j] * heard(j)).imag() * (turn[k] * heard(k)).imag() / (std::abs(held) + soft);
    }
  }
  for (std::size_t j = 0; j < foci; ++j) {
    EXPECT_NEAR(std::abs(pressure[j] - expected[j]), 0, 1e-4 * std::abs(expected[j]));
    for (std::size_t k = 0; k < foci; ++k)
      EXPECT_NEAR(growth[j * foci + k], by_hand[j * foci + k], 1e-4 * by_hand[j * foci + j]);
  }
}

}  // namespace
}  // namespace palpa::array
