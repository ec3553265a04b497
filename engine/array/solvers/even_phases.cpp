#include "array/solvers/even_phases.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Computes the pressure of `drive` into `pressure`, and C. Products are written out, because those of std::complex
/// check for infinities.
void listen(const Columns& columns, std::span<const Complex> drive, std::span<Complex> pressure,
            std::span<Complex> across) {
  const std::size_t foci = columns.foci;
  std::array<double, most_solved_foci> re{}, im{}, sum_re{}, sum_im{};
  std::ranges::fill(across, Complex(0));
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const double x = drive[n].real(), y = drive[n].imag();
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      re[j] = columns.loud[entry] * (x * columns.cosine[entry] - y * columns.sine[entry]);
      im[j] = columns.loud[entry] * (x * columns.sine[entry] + y * columns.cosine[entry]);
      sum_re[j] += re[j];
      sum_im[j] += im[j];
    }
    for (std::size_t j = 0; j < foci; ++j) {
      auto* const row = reinterpret_cast<double*>(&across[j * foci]);
      for (std::size_t k = 0; k <= j; ++k) {
        row[2 * k] += re[j] * re[k] - im[j] * im[k];
        row[2 * k + 1] += re[j] * im[k] + im[j] * re[k];
      }
    }
  }
  for (std::size_t j = 0; j < foci; ++j)
    pressure[j] = {sum_re[j], sum_im[j]};
}

/// Computes A, which does not depend on the phases of the transducers.
void find_alike(const Columns& columns, std::span<const Complex> drive, std::span<Complex> alike) {
  const std::size_t foci = columns.foci;
  std::ranges::fill(alike, Complex(0));
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const std::size_t first = n * foci;
    const double part = std::norm(drive[n]);
    for (std::size_t j = 0; j < foci; ++j) {
      auto* const row = reinterpret_cast<double*>(&alike[j * foci]);
      const double x = part * columns.loud[first + j] * columns.cosine[first + j];
      const double y = part * columns.loud[first + j] * columns.sine[first + j];
      for (std::size_t k = 0; k <= j; ++k) {
        const double re = columns.loud[first + k] * columns.cosine[first + k];
        const double im = columns.loud[first + k] * columns.sine[first + k];
        row[2 * k] += x * re + y * im;
        row[2 * k + 1] += y * re - x * im;
      }
    }
  }
}

/// Fills `tried`: the transducers' drives with phases changed by J^T y. `pull` is y_j u_j* divided by the target of
/// focus j.
void turn(const Columns& columns, std::span<const Complex> pull, std::span<const Complex> drive,
          std::span<Complex> tried) {
  const std::size_t foci = columns.foci;
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    double re = 0, im = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      const double x = columns.loud[entry] * columns.cosine[entry], y = columns.loud[entry] * columns.sine[entry];
      re += pull[j].real() * x - pull[j].imag() * y;
      im += pull[j].real() * y + pull[j].imag() * x;
    }
    const double by = -(re * drive[n].imag() + im * drive[n].real());
    const double cosine = std::cos(by), sine = std::sin(by);
    tried[n] = {drive[n].real() * cosine - drive[n].imag() * sine, drive[n].real() * sine + drive[n].imag() * cosine};
  }
}

/// The pull of the next step.
void find_pull(std::span<const double> targets, double level, double more, double damping, PhaseScratch& scratch) {
  const std::size_t foci = targets.size();
  for (std::size_t j = 0; j < foci; ++j) {
    const double heard = magnitude(scratch.pressure[j]), wanted = targets[j] * level;
    scratch.pull[j] = heard > 0 && wanted > 0 ? std::conj(scratch.pressure[j]) / (heard * wanted) : Complex(0);
    scratch.rest[j] = wanted > 0 ? scratch.miss[j] + more : 0;
  }
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t k = 0; k <= j; ++k) {
      const Complex alike = scratch.pull[j] * std::conj(scratch.pull[k]) * scratch.alike[j * foci + k];
      const Complex across = scratch.pull[j] * scratch.pull[k] * scratch.across[j * foci + k];
      scratch.normal[j * foci + k] = scratch.normal[k * foci + j] = (alike.real() - across.real()) / 2;
    }
  }
  solve_damped(scratch.normal, damping, false, scratch.rest);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.pull[j] *= scratch.rest[j];
}

}  // namespace

Evened even_phases(const Columns& columns, std::span<const double> targets, double most_miss, std::uint32_t tries,
                   std::span<Complex> drive, PhaseScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(targets.size() == foci && drive.size() == columns.transducers && foci <= most_solved_foci);
  scratch.tried.resize(drive.size());
  for (std::vector<Complex>* values : {&scratch.pressure, &scratch.tried_pressure, &scratch.pull})
    values->resize(foci);
  for (std::vector<Complex>* values : {&scratch.alike, &scratch.across, &scratch.tried_across})
    values->resize(foci * foci);
  scratch.normal.resize(foci * foci);
  for (std::vector<double>* values : {&scratch.rest, &scratch.miss, &scratch.tried_miss})
    values->resize(foci);

  listen(columns, drive, scratch.pressure, scratch.across);
  double level = level_of(scratch.pressure, targets);
  double missed = find_misses(scratch.pressure, targets, level, scratch.miss);
  if (largest_miss(scratch.miss) <= most_miss) return {largest_miss(scratch.miss), 0};
  find_alike(columns, drive, scratch.alike);
  double weakest = weakest_of(targets, [&](std::size_t j) { return magnitude(scratch.pressure[j]); });
  double damping = even_damping;
  std::uint32_t raises = largest_miss(scratch.miss) > phases_uneven ? phases_raises : 0;
  std::uint32_t made = 0;
  while ((raises > 0 || largest_miss(scratch.miss) > most_miss) && made < tries && damping <= even_most_damping) {
    find_pull(targets, level, raises > 0 ? phases_push : 0, damping, scratch);
    turn(columns, scratch.pull, drive, scratch.tried);
    listen(columns, scratch.tried, scratch.tried_pressure, scratch.tried_across);
    const double level_then = level_of(scratch.tried_pressure, targets);
    const double missed_then = find_misses(scratch.tried_pressure, targets, level_then, scratch.tried_miss);
    const double weakest_then =
        weakest_of(targets, [&](std::size_t j) { return magnitude(scratch.tried_pressure[j]); });
    const bool stays =
        raises > 0 ? weakest_then > weakest : missed_then < missed && weakest_then >= phases_keep * weakest;
    if (stays) {
      level = level_then;
      missed = missed_then;
      weakest = weakest_then;
      std::ranges::copy(scratch.tried, drive.begin());
      std::swap(scratch.pressure, scratch.tried_pressure);
      std::swap(scratch.across, scratch.tried_across);
      std::swap(scratch.miss, scratch.tried_miss);
      damping = std::max(damping * even_less, even_least_damping);
    } else {
      damping *= even_more;
    }
    ++made;
    if (raises > 0 && --raises == 0) damping = even_damping;
  }
  return {largest_miss(scratch.miss), made};
}

}  // namespace palpa::array
