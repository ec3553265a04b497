#include "array/solvers/gs_pat.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "array/solvers/greedy.hpp"
#include "array/solvers/gs_pat_few.hpp"
#include "array/solvers/gs_pat_step.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The phase of `p`, or of `otherwise` if p is 0, with magnitude `size`.
Complex turned(double size, const Complex& p, const Complex& otherwise) {
  const double most = magnitude(p);
  if (most > 0) return size * p / most;
  const double other = magnitude(otherwise);
  return other > 0 ? size * otherwise / other : Complex(size, 0);
}

/// For more foci than gs_pat_few.
void solve_many(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
                std::span<FocusWeight> weights, GsPatScratch& scratch) {
  const std::size_t foci = columns.foci;
  gs_pat_start(matrix, columns, 0, scratch.claims, scratch.factors);
  gs_pat_climb_to(matrix, scratch.claims, {0, static_cast<double>(foci)}, gs_pat_steps, scratch.factors,
                  scratch.pressure);
  for (std::size_t j = 0; j < foci; ++j)
    weights[j].plain = scratch.factors[j];

  for (std::size_t j = 0; j < foci; ++j)
    scratch.targets[j] = gains[j] * scratch.claims[j];
  if (std::ranges::any_of(gains, [](double gain) { return gain != 1; })) {
    hear(matrix, scratch.factors, scratch.pressure);
    const double level = level_of(scratch.pressure, scratch.claims);
    for (std::size_t j = 0; j < foci; ++j)
      scratch.factors[j] *= gains[j];
    gs_pat_climb_to(matrix, scratch.targets, {level, 0}, gs_pat_steps, scratch.factors, scratch.pressure);
  }
  if (constraint != Constraint::normalise) {
    double sum = 0;
    for (const double gain : gains)
      sum += gain;
    for (std::uint32_t i = 0; i < gs_pat_refinings; ++i) {
      hear_bounded(columns, constraint, scratch.factors, scratch.pressure);
      gs_pat_step(scratch.pressure, scratch.targets, {0, sum}, scratch.factors);
    }
  }
  for (std::size_t j = 0; j < foci; ++j)
    weights[j].heard = scratch.factors[j];
}

}  // namespace

std::uint32_t gs_pat_most_tries(std::size_t transducers) {
  // 16 threads share the transducers; the loops over foci take about 300 iterations. The margin covers the work before
  // the first try and after the last.
  const std::size_t iterations = transducers / 16 + 1 + 300;
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(45'000 / iterations, 1, gs_pat_phase_tries));
}

double heard_part(const FocusMatrix& matrix, std::size_t j, std::size_t k) {
  const double alone = matrix.alone(j) * matrix.alone(k);
  return matrix.alone(j) > 0 && alone > 0 ? std::min(1.0, magnitude(matrix.at(j, k)) / std::sqrt(alone)) : 0;
}

void find_claims(const FocusMatrix& matrix, std::vector<double>& claims) {
  double loudest = 0;
  for (std::size_t j = 0; j < matrix.foci; ++j)
    loudest = std::max(loudest, matrix.alone(j));
  claims.resize(matrix.foci);
  for (std::size_t j = 0; j < matrix.foci; ++j) {
    const double alone = std::max(0.0, matrix.alone(j));
    claims[j] = loudest > 0 ? std::min(1.0, gs_pat_most_help * alone / loudest) : 1.0;
  }
}

void gs_pat_start(const FocusMatrix& matrix, const Columns& columns, std::uint32_t start,
                  std::span<const double> claims, std::span<Complex> factors) {
  double sizes[most_solved_foci];
  double total = 0;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const double alone = matrix.alone(j);
    sizes[j] = alone > 0 ? claims[j] / alone : 0;
    total += sizes[j];
  }
  const auto foci = static_cast<double>(factors.size());
  const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(columns.transducers));
  const std::size_t first = std::size_t{start} * gs_pat_sounds;
  const std::uint32_t sounds = columns.transducers == 0 ? 0 : start == 0 ? 1 : gs_pat_sounds;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const double size = total > 0 ? std::min(sizes[j] * foci / total, gs_pat_most_weight) : 1;
    Complex sound = 0;
    for (std::uint32_t i = 0; i < sounds; ++i) {
      const std::size_t entry = (first + i) * stride % columns.transducers * columns.foci + j;
      sound += Complex(columns.cosine[entry], -columns.sine[entry]);
    }
    factors[j] = turned(size, sound, 1);
  }
}

double gs_pat_step(std::span<const Complex> pressure, std::span<const double> targets, const GsPatGoal& goal,
                   std::span<Complex> factors) {
  const double level = goal.level > 0 ? goal.level : level_of(pressure, targets);
  double sizes[most_solved_foci];
  double total = 0;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const double wanted = targets[j] * level;
    const double heard = magnitude(pressure[j]);
    // At most a factor of four per step: a pressure near zero is unreliable.
    sizes[j] = magnitude(factors[j]) * (wanted < 4 * heard ? wanted / heard : 4);
    total += sizes[j];
  }
  const double scale = goal.sum > 0 && total > 0 ? goal.sum / total : 1;
  double moved = 0;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const double size = std::min(sizes[j] * scale, gs_pat_most_weight);
    const Complex next = turned(size, pressure[j], factors[j]);
    moved = std::max(moved, magnitude(next - factors[j]));
    factors[j] = next;
  }
  return moved;
}

void gs_pat_climb_to(const FocusMatrix& matrix, std::span<const double> targets, const GsPatGoal& goal,
                     std::uint32_t steps, std::span<Complex> factors, std::vector<Complex>& pressure) {
  for (std::uint32_t i = 0; i < steps; ++i) {
    hear(matrix, factors, pressure);
    if (gs_pat_step(pressure, targets, goal, factors) < gs_pat_still) break;
  }
}

bool some_hear(const FocusMatrix& matrix, double least) {
  for (std::size_t j = 0; j < matrix.foci; ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      if (heard_part(matrix, j, k) >= least) return true;
    }
  }
  return false;
}

void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            std::span<FocusWeight> weights, GsPatScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(weights.size() == foci && gains.size() == foci && foci <= most_solved_foci);
  for (std::vector<Complex>* values : {&scratch.pressure, &scratch.factors, &scratch.start})
    values->resize(foci);
  scratch.targets.resize(foci);
  find_claims(matrix, scratch.claims);
  const auto solve = foci <= gs_pat_few ? solve_few : solve_many;
  solve(matrix, columns, gains, constraint, weights, scratch);
}

void gs_pat_turn(const Columns& columns, Constraint constraint, std::span<Complex> sums, GsPatScratch& scratch) {
  if (constraint == Constraint::normalise || columns.foci > gs_pat_few) return;
  for (Complex& sum : sums)
    sum = bounded(sum, constraint);
  even_phases(columns, scratch.targets, gs_pat_miss, gs_pat_most_tries(columns.transducers), sums, scratch.phases);
}

}  // namespace palpa::array
