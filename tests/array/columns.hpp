// The free field's columns for foci, and what the drives that solvers work on give.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "array/drive_options.hpp"
#include "array/field/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "array/solvers/hearing.hpp"
#include "focus_sets.hpp"

namespace palpa::array {

inline Columns columns_of(const Layout& layout, const std::vector<SlotFocus>& foci, Weighting weighting,
                          Directivity directivity = Directivity::t4010a1) {
  FreeField field;
  field.set(layout, {}, directivity);
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci)
    sources.push_back({focus.position, farthest_of(layout, focus.position), 1});
  Columns columns;
  field.fill(sources, weighting, columns);
  return columns;
}

/// The transducers' drives if every focus only asks.
inline std::vector<std::complex<double>> sums_of(const Columns& columns, Constraint constraint, double divided_by = 1) {
  std::vector<std::complex<double>> sums(columns.transducers);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    for (std::size_t j = 0; j < columns.foci; ++j)
      sums[n] += columns.ask(n * columns.foci + j) / divided_by;
    sums[n] = bounded(sums[n], constraint);
  }
  return sums;
}

/// The pressure at each focus.
inline std::vector<double> heard_of(const Columns& columns, const std::vector<std::complex<double>>& drive) {
  std::vector<double> heard;
  for (std::size_t j = 0; j < columns.foci; ++j) {
    std::complex<double> sum = 0;
    for (std::size_t n = 0; n < drive.size(); ++n)
      sum += columns.transfer(n * columns.foci + j) * drive[n];
    heard.push_back(std::abs(sum));
  }
  return heard;
}

}  // namespace palpa::array
