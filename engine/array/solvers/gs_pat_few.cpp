#include "array/solvers/gs_pat_few.hpp"

#include <algorithm>
#include <cmath>

#include "array/solvers/gs_pat_step.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The power that the factors take from the array: the sum of |s|^2 over the transducers, each weighted by the share of
/// it that arrives.
double power_of(std::span<const Complex> factors, std::span<const Complex> pressure) {
  double sum = 0;
  for (std::size_t j = 0; j < factors.size(); ++j)
    sum += factors[j].real() * pressure[j].real() + factors[j].imag() * pressure[j].imag();
  return sum;
}

/// The loudness of the weakest focus relative to the power of the factors.
double merit_of(std::span<const Complex> factors, std::span<const Complex> pressure, std::span<const double> targets) {
  const double power = power_of(factors, pressure);
  const double weakest = weakest_of(targets, [&](std::size_t j) { return magnitude(pressure[j]); });
  return power > 0 ? weakest / std::sqrt(power) : 0;
}

/// Computes the plain factors.
void solve_plain(const FocusMatrix& matrix, const Columns& columns, std::uint32_t tries, GsPatScratch& scratch) {
  const std::uint32_t starts = some_hear(matrix, gs_pat_hears) ? gs_pat_starts : 1;
  double best = -1;
  for (std::uint32_t i = 0; i < starts; ++i) {
    gs_pat_start(matrix, columns, i, scratch.claims, scratch.start);
    gs_pat_climb_to(matrix, scratch.claims, {0, static_cast<double>(matrix.foci)},
                    starts > 1 ? gs_pat_climb : gs_pat_steps, scratch.start, scratch.pressure);
    if (starts > 1) even_out(matrix, scratch.claims, {0, gs_pat_miss, gs_pat_look}, scratch.start, scratch.even);
    hear(matrix, scratch.start, scratch.pressure);
    const double merit = merit_of(scratch.start, scratch.pressure, scratch.claims);
    if (i > 0 && !(merit > best * gs_pat_better)) continue;
    best = merit;
    scratch.factors = scratch.start;
  }
  even_out(matrix, scratch.claims, {0, gs_pat_miss, tries}, scratch.factors, scratch.even);
}

}  // namespace

void find_targets(const FocusMatrix& matrix, std::span<const double> gains, GsPatScratch& scratch) {
  for (std::size_t j = 0; j < matrix.foci; ++j) {
    double gain = gains[j];
    for (std::size_t k = 0; k < matrix.foci; ++k) {
      if (k == j) continue;
      const double same = (heard_part(matrix, j, k) - gs_pat_same) / (1 - gs_pat_same);
      gain = std::max(gain, gains[k] * std::clamp(same, 0.0, 1.0));
    }
    scratch.targets[j] = gain * scratch.claims[j];
  }
}

void fill_up(const FocusMatrix& matrix, std::span<const double> gains, GsPatScratch& scratch) {
  hear(matrix, scratch.factors, scratch.pressure);
  const double power = power_of(scratch.factors, scratch.pressure);
  double alone = 0, wanted = 0;
  for (std::size_t j = 0; j < gains.size(); ++j) {
    alone += matrix.alone(j) / static_cast<double>(gains.size());
    wanted += gains[j] * gains[j];
  }
  if (!(power > 0) || !(alone > 0)) return;
  const double by = gs_pat_fill * std::sqrt(wanted * alone / power);
  for (Complex& factor : scratch.factors)
    factor *= by;
}

void solve_few(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
               std::span<FocusWeight> weights, GsPatScratch& scratch) {
  const std::size_t foci = columns.foci;
  const std::uint32_t tries = constraint == Constraint::normalise ? gs_pat_tries : gs_pat_bounded_tries;
  solve_plain(matrix, columns, tries, scratch);
  for (std::size_t j = 0; j < foci; ++j)
    weights[j].plain = scratch.factors[j];

  find_targets(matrix, gains, scratch);
  if (std::ranges::any_of(gains, [](double gain) { return gain != 1; })) {
    hear(matrix, scratch.factors, scratch.pressure);
    const double level = level_of(scratch.pressure, scratch.claims);
    for (std::size_t j = 0; j < foci; ++j)
      scratch.factors[j] *= gains[j];
    even_out(matrix, scratch.targets, {level, gs_pat_miss, tries}, scratch.factors, scratch.even);
  }
  if (constraint == Constraint::clamp) fill_up(matrix, gains, scratch);
  for (std::size_t j = 0; j < foci; ++j)
    weights[j].heard = scratch.factors[j];
}

}  // namespace palpa::array
