#include "array/pressures/slot_pressures.hpp"

#include <algorithm>
#include <cassert>

#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The targets of the foci; each is at least that of a coinciding focus.
std::span<const double> one_sound(const FocusMatrix& matrix, std::span<const double> targets,
                                  std::vector<double>& raised) {
  raised.assign(targets.begin(), targets.end());
  for (std::size_t j = 0; j < targets.size(); ++j) {
    if (!(targets[j] > 0)) continue;
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (targets[k] <= raised[j]) continue;
      const double same = (heard_part(matrix, j, k) - gs_pat_same) / (1 - gs_pat_same);
      raised[j] = std::max(raised[j], targets[k] * std::clamp(same, 0.0, 1.0));
    }
  }
  return raised;
}

/// The factors of gs_pat, scaled to the requested loudness.
void start_together(const FocusMatrix& matrix, const Columns& columns, std::span<const double> targets,
                    std::span<Complex> factors, PressureScratch& scratch) {
  const double most = *std::ranges::max_element(targets);
  scratch.gains.assign(targets.begin(), targets.end());
  for (double& gain : scratch.gains)
    gain /= most;
  scratch.weights.resize(factors.size());
  gs_pat(matrix, columns, scratch.gains, Constraint::normalise, scratch.weights, scratch.gs_pat);
  for (std::size_t j = 0; j < factors.size(); ++j)
    factors[j] = scratch.weights[j].heard;
  std::vector<Complex>& pressure = scratch.gs_pat.pressure;
  pressure.resize(factors.size());
  hear(matrix, factors, pressure);
  const double level = level_of(pressure, targets);
  for (Complex& factor : factors)
    factor = level > 0 ? factor / level : 0;
}

}  // namespace

void start_pressures(const FocusMatrix& matrix, const Columns& columns, FocusPhases phases,
                     std::span<const double> targets, std::span<Complex> factors, PressureScratch& scratch) {
  const bool sounds = std::ranges::any_of(targets, [](double target) { return target > 0; });
  assert(factors.size() <= most_solved_foci);
  if (sounds && factors.size() > 1 && phases == FocusPhases::helping) {
    start_together(matrix, columns, targets, factors, scratch);
  } else {
    for (std::size_t j = 0; j < factors.size(); ++j)
      factors[j] = matrix.alone(j) > 0 ? targets[j] / matrix.alone(j) : 0;
  }
}

void correct_pressures(const FocusMatrix& matrix, std::span<const double> targets, std::span<Complex> factors,
                       PressureScratch& scratch) {
  if (factors.size() < 2) return;
  even_out(matrix, one_sound(matrix, targets, scratch.targets), {1, pressure_miss, pressure_tries, true}, factors,
           scratch.even);
}

}  // namespace palpa::array
