#include "array/slot_pressures.hpp"

#include <algorithm>

#include "array/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The factors of gs_pat, as loud as asked on the whole.
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
  MatrixHearing(matrix).hear(factors, pressure);
  const double level = level_of(pressure, targets);
  for (Complex& factor : factors)
    factor = level > 0 ? factor / level : 0;
}

}  // namespace

void solve_pressures(const FocusMatrix& matrix, const Columns& columns, FocusPhases phases,
                     std::span<const double> targets, std::span<Complex> factors, PressureScratch& scratch) {
  const bool sounds = std::ranges::any_of(targets, [](double target) { return target > 0; });
  const bool several = factors.size() > 1 && factors.size() <= most_solved_foci;
  if (sounds && several && phases == FocusPhases::helping) {
    start_together(matrix, columns, targets, factors, scratch);
  } else {
    for (std::size_t j = 0; j < factors.size(); ++j)
      factors[j] = matrix.alone(j) > 0 ? targets[j] / matrix.alone(j) : 0;
  }
  if (sounds) correct_pressures(matrix, targets, factors, scratch);
}

void correct_pressures(const FocusMatrix& matrix, std::span<const double> targets, std::span<Complex> factors,
                       PressureScratch& scratch) {
  if (factors.size() < 2 || factors.size() > most_solved_foci) return;
  even_out(MatrixHearing(matrix), targets, {1, pressure_miss, pressure_tries}, factors, scratch.even);
}

}  // namespace palpa::array
