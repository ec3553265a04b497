// Evening out by the phases of transducers alone: how even foci become, and what stays unchanged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "array/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/even_phases.hpp"
#include "array/solvers/hearing.hpp"
#include "focus_sets.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

Columns columns_of(const Layout& layout, const std::vector<SlotFocus>& foci) {
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci) {
    double reach = 0;
    for (const Transducer& transducer : layout.transducers)
      reach = std::max(reach, glm::distance(transducer.position, focus.position));
    sources.push_back({focus.position, reach, 1});
  }
  Columns columns;
  field.fill(sources, Weighting::distance, columns);
  return columns;
}

/// The transducers' drives if every focus only asks.
std::vector<Complex> sums_of(const Columns& columns, Constraint constraint) {
  std::vector<Complex> sums(columns.transducers);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    for (std::size_t j = 0; j < columns.foci; ++j)
      sums[n] += columns.ask(n * columns.foci + j) / 3.0;
    sums[n] = bounded(sums[n], constraint);
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

// From phases that leave some foci almost silent to even foci: no magnitude changes, the weakest becomes far louder.
TEST(EvenPhases, EvenOutWhateverTheAmplitudes) {
  const Layout layout = load_layout("autd3");
  for (const Constraint constraint : {Constraint::uniform, Constraint::clamp}) {
    for (const double radius : {6e-3, 7e-3}) {
      const Columns columns = columns_of(layout, ring(10, radius, {0, 0, 0.15}, {1, 0, 0}, {0, 0, 1}));
      const std::vector<double> targets(columns.foci, 1);
      const std::vector<Complex> first = sums_of(columns, constraint);
      std::vector<Complex> drive = first;
      PhaseScratch scratch;
      const Evened evened = even_phases(columns, targets, 0.0045, 60, drive, scratch);
      EXPECT_LE(evened.miss, 0.0045);
      EXPECT_LE(evened.tries, 60u);
      const auto before = heard_of(columns, first), after = heard_of(columns, drive);
      EXPECT_LT(*std::ranges::min_element(before), 0.7 * *std::ranges::max_element(before));  // there is something to
                                                                                              // improve
      EXPECT_GE(*std::ranges::min_element(after), 0.99 * *std::ranges::max_element(after));
      EXPECT_GT(*std::ranges::min_element(after), 1.2 * *std::ranges::min_element(before));
      for (std::size_t n = 0; n < drive.size(); ++n)
        ASSERT_NEAR(std::abs(drive[n]), std::abs(first[n]), 1e-12) << n;
    }
  }
}

TEST(EvenPhases, TargetsAreRelativeAndMayBeNone) {
  const Layout layout = load_layout("openmpd");
  const Columns columns = columns_of(layout, focus_set(3, 4, {0, 0, 0.15}));
  std::vector<Complex> drive = sums_of(columns, Constraint::uniform);
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
TEST(EvenPhases, LeavesWhatIsEven) {
  const Layout layout = load_layout("openmpd");
  const Columns columns = columns_of(layout, focus_set(3, 4, {0, 0, 0.15}));
  std::vector<Complex> drive = sums_of(columns, Constraint::uniform);
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
