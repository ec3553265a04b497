#include "array/solvers/even_out.hpp"

#include <algorithm>
#include <cmath>

#include "array/solvers/complex_system.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Fills J. A focus without pressure has no slope.
void find_slopes(const FocusMatrix& matrix, std::span<const double> targets, double level, EvenScratch& scratch) {
  for (std::size_t row = 0; row < matrix.foci; ++row) {
    const Complex& heard = scratch.pressure[row];
    const double size = magnitude(heard), wanted = targets[row] * level;
    const Complex turn = size > 0 && wanted > 0 ? std::conj(heard) / size / wanted : Complex(0);
    for (std::size_t column = 0; column < matrix.foci; ++column)
      scratch.slopes[row * matrix.foci + column] = turn * matrix.at(row, column);
  }
}

/// The factors after one damped step. `scratch.slopes` are J.
void step(std::span<const Complex> factors, double damping, bool by_focus, EvenScratch& scratch) {
  const std::size_t foci = factors.size();
  for (std::size_t a = 0; a < foci; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double sum = 0;
      for (std::size_t q = 0; q < foci; ++q) {
        const Complex& x = scratch.slopes[a * foci + q];
        const Complex& y = scratch.slopes[b * foci + q];
        sum += x.real() * y.real() + x.imag() * y.imag();
      }
      scratch.normal[a * foci + b] = scratch.normal[b * foci + a] = sum;
    }
  }
  std::ranges::copy(scratch.miss, scratch.rest.begin());
  solve_damped(scratch.normal, damping, by_focus, scratch.rest);
  for (std::size_t q = 0; q < foci; ++q) {
    Complex sum = factors[q];
    for (std::size_t a = 0; a < foci; ++a)
      sum += std::conj(scratch.slopes[a * foci + q]) * scratch.rest[a];
    scratch.tried[q] = sum;
  }
}

}  // namespace

double level_of(std::span<const Complex> pressure, std::span<const double> targets) {
  double heard = 0, wanted = 0;
  for (std::size_t j = 0; j < pressure.size(); ++j) {
    heard += magnitude(pressure[j]);
    wanted += targets[j];
  }
  return wanted > 0 ? heard / wanted : 0;
}

double find_misses(std::span<const Complex> pressure, std::span<const double> targets, double level,
                   std::span<double> miss) {
  double sum = 0;
  for (std::size_t j = 0; j < pressure.size(); ++j) {
    const double wanted = targets[j] * level;
    miss[j] = wanted > 0 ? 1 - magnitude(pressure[j]) / wanted : 0;
    sum += miss[j] * miss[j];
  }
  return sum;
}

double largest_miss(std::span<const double> miss) {
  double most = 0;
  for (const double m : miss)
    most = std::max(most, std::abs(m));
  return most;
}

void solve_damped(std::span<double> normal, double damping, bool by_focus, std::span<double> rest) {
  const std::size_t foci = rest.size();
  double trace = 0;
  for (std::size_t a = 0; a < foci; ++a)
    trace += normal[a * foci + a];
  for (std::size_t a = 0; a < foci; ++a) {
    double& diagonal = normal[a * foci + a];
    diagonal += std::max(damping * (by_focus ? diagonal : trace / static_cast<double>(foci)), 1e-30);
  }
  solve_positive(normal, {rest});
}

Evened even_out(const FocusMatrix& matrix, std::span<const double> targets, const EvenGoal& goal,
                std::span<Complex> factors, EvenScratch& scratch) {
  const std::size_t foci = factors.size();
  for (std::vector<Complex>* values : {&scratch.pressure, &scratch.tried_pressure, &scratch.tried})
    values->resize(foci);
  scratch.slopes.resize(foci * foci);
  scratch.normal.resize(foci * foci);
  for (std::vector<double>* values : {&scratch.rest, &scratch.miss})
    values->resize(foci);
  const auto level = [&](std::span<const Complex> pressure) {
    return goal.level > 0 ? goal.level : level_of(pressure, targets);
  };

  hear(matrix, factors, scratch.pressure);
  double missed = find_misses(scratch.pressure, targets, level(scratch.pressure), scratch.miss);
  double damping = even_damping;
  std::uint32_t tries = 0;
  while (largest_miss(scratch.miss) > goal.most_miss && tries < goal.tries && damping <= even_most_damping) {
    find_slopes(matrix, targets, level(scratch.pressure), scratch);
    while (tries < goal.tries && damping <= even_most_damping) {
      step(factors, damping, goal.by_focus, scratch);
      ++tries;
      hear(matrix, scratch.tried, scratch.tried_pressure);
      const double then = find_misses(scratch.tried_pressure, targets, level(scratch.tried_pressure), scratch.rest);
      if (then < missed) {
        missed = then;
        std::ranges::copy(scratch.tried, factors.begin());
        std::swap(scratch.pressure, scratch.tried_pressure);
        std::swap(scratch.miss, scratch.rest);
        damping = std::max(damping * even_less, even_least_damping);
        break;
      }
      damping *= even_more;
    }
  }
  return {largest_miss(scratch.miss), tries};
}

}  // namespace palpa::array
