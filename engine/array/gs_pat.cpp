#include "array/gs_pat.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// p = R c, through the member of `weights` that is meant.
void hear(const FocusMatrix& matrix, std::span<const FocusWeight> weights, Complex FocusWeight::*factor,
          std::vector<Complex>& pressure) {
  const std::size_t foci = weights.size();
  for (std::size_t row = 0; row < foci; ++row) {
    Complex sum = 0;
    for (std::size_t column = 0; column < foci; ++column)
      sum += matrix.at(row, column) * weights[column].*factor;
    pressure[row] = sum;
  }
}

/// p = G P(B c).
void radiate(const Columns& columns, std::span<const FocusWeight> weights, Constraint constraint,
             std::vector<Complex>& pressure) {
  std::ranges::fill(pressure, 0);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const std::size_t first = n * columns.foci;
    Complex sum = 0;
    for (std::size_t j = 0; j < columns.foci; ++j)
      sum += weights[j].heard * columns.ask(first + j);
    const double size = std::abs(sum);
    if (size > 0 && (constraint == Constraint::uniform || size > 1)) sum /= size;
    for (std::size_t j = 0; j < columns.foci; ++j)
      pressure[j] += sum * columns.transfer(first + j);
  }
}

/// The phase of `p`, or of `otherwise` where p has none, at magnitude `size`.
Complex turned(double size, const Complex& p, const Complex& otherwise) {
  const double most = std::abs(p);
  if (most > 0) return size * p / most;
  const double other = std::abs(otherwise);
  return other > 0 ? size * otherwise / other : Complex(size, 0);
}

/// How loud all are over how loud all are to be.
double level_of(const std::vector<Complex>& pressure, std::span<const double> targets) {
  double heard = 0, wanted = 0;
  for (std::size_t j = 0; j < pressure.size(); ++j) {
    heard += std::abs(pressure[j]);
    wanted += targets[j];
  }
  return wanted > 0 ? heard / wanted : 0;
}

/// One step of all factors towards t_j `level`, or half of it; where `sum` is not 0 their magnitudes then have that
/// sum. Returns how far the farthest moved.
double step(std::span<FocusWeight> weights, Complex FocusWeight::*factor, const std::vector<Complex>& pressure,
            std::span<const double> targets, double level, double sum, bool halfway = false) {
  double sizes[most_solved_foci];
  double total = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const double size = std::abs(weights[j].*factor);
    const double wanted = targets[j] * level;
    const double heard = std::abs(pressure[j]);
    // No more than four times per step: a pressure near zero says little.
    const double ratio = wanted < 4 * heard ? wanted / heard : 4;
    sizes[j] = size * (halfway ? std::sqrt(ratio) : ratio);
    total += sizes[j];
  }
  const double scale = sum > 0 && total > 0 ? sum / total : 1;
  double moved = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const double size = std::min(sizes[j] * scale, gs_pat_most_weight);
    const Complex next = turned(size, pressure[j], weights[j].*factor);
    moved = std::max(moved, std::abs(next - weights[j].*factor));
    weights[j].*factor = next;
  }
  return moved;
}

/// What part of full loudness each focus may claim.
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

/// Phases from the way to the first transducer, weights as if each sounded alone.
void start(const FocusMatrix& matrix, const Columns& columns, std::span<const double> claims,
           std::span<FocusWeight> weights) {
  const std::size_t foci = weights.size();
  double total = 0;
  double sizes[most_solved_foci];
  for (std::size_t j = 0; j < foci; ++j) {
    const double alone = matrix.alone(j);
    sizes[j] = alone > 0 ? claims[j] / alone : 0;
    total += sizes[j];
  }
  for (std::size_t j = 0; j < foci; ++j) {
    const double size = total > 0 ? std::min(sizes[j] * static_cast<double>(foci) / total, gs_pat_most_weight) : 1;
    weights[j].plain = columns.transducers > 0 ? size * Complex(columns.cosine[j], -columns.sine[j]) : Complex(size, 0);
  }
}

}  // namespace

void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            std::span<FocusWeight> weights, GsPatScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(weights.size() == foci && gains.size() == foci && foci <= most_solved_foci);
  scratch.pressure.resize(foci);
  find_claims(matrix, scratch.claims);
  start(matrix, columns, scratch.claims, weights);

  for (std::uint32_t i = 0; i < gs_pat_steps; ++i) {
    hear(matrix, weights, &FocusWeight::plain, scratch.pressure);
    const double level = level_of(scratch.pressure, scratch.claims);
    if (step(weights, &FocusWeight::plain, scratch.pressure, scratch.claims, level, static_cast<double>(foci)) <
        gs_pat_still)
      break;
  }

  for (FocusWeight& weight : weights)
    weight.heard = weight.plain;
  scratch.targets.resize(foci);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.targets[j] = gains[j] * scratch.claims[j];
  const bool differ = std::ranges::any_of(gains, [](double gain) { return gain != 1; });
  if (differ) {
    hear(matrix, weights, &FocusWeight::plain, scratch.pressure);
    const double level = level_of(scratch.pressure, scratch.claims);
    for (std::size_t j = 0; j < foci; ++j)
      weights[j].heard *= gains[j];
    for (std::uint32_t i = 0; i < gs_pat_steps; ++i) {
      hear(matrix, weights, &FocusWeight::heard, scratch.pressure);
      if (step(weights, &FocusWeight::heard, scratch.pressure, scratch.targets, level, 0) < gs_pat_still) break;
    }
  }
  if (constraint == Constraint::normalise) return;
  double sum = 0;
  for (const double gain : gains)
    sum += gain;
  for (std::uint32_t i = 0; i < gs_pat_refinings; ++i) {
    radiate(columns, weights, constraint, scratch.pressure);
    step(weights, &FocusWeight::heard, scratch.pressure, scratch.targets, level_of(scratch.pressure, scratch.targets),
         sum, foci <= gs_pat_few);
  }
}

}  // namespace palpa::array
