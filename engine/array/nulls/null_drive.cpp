#include "array/nulls/null_drive.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr double looser = 3.1622776601683795;  // from one rest to the next that is tried

/// Fills R' for the first rows of Q. Returns the smallest part of its power that a focus keeps.
double without_rows(const FocusMatrix& matrix, std::size_t rows, NullScratch& scratch) {
  const std::size_t foci = matrix.foci;
  scratch.matrix.foci = foci;
  scratch.matrix.re = matrix.re;
  scratch.matrix.im = matrix.im;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t column = 0; column < foci; ++column) {
      for (std::size_t row = 0; row < foci; ++row) {
        const Complex lost = std::conj(scratch.across[i * foci + row]) * scratch.heard[i * foci + column];
        scratch.matrix.re[column * foci + row] -= lost.real();
        scratch.matrix.im[column * foci + row] -= lost.imag();
      }
    }
  }
  double least = 1;
  for (std::size_t j = 0; j < foci; ++j) {
    if (matrix.alone(j) > 0) least = std::min(least, scratch.matrix.alone(j) / matrix.alone(j));
  }
  return least;
}

/// Replaces what one focus asks for by its own sound, and fills its R. With even amplitudes, these are the same phases,
/// and the nearest silent drive then has nearly those of the loudest one (docs/notes/nulls.md#uniform-and-clamp).
void ask_own_sound(NullScratch& scratch) {
  scratch.asked = scratch.sounds;
  for (double& im : scratch.asked.im)
    im = -im;
  scratch.own.foci = 1;
  scratch.own.re.assign(1, inner_product(scratch.sounds, 0, scratch.sounds, 0).real());
  scratch.own.im.assign(1, 0);
}

/// Fills R', and returns how many rows it is without.
std::size_t choose_rows(const Nulls& nulls, const FocusMatrix& matrix, Constraint constraint, NullScratch& scratch) {
  const std::size_t foci = matrix.foci, all = nulls.rows().rows;
  scratch.heard.resize(all * foci);
  scratch.across.resize(all * foci);
  double rest = constraint == Constraint::uniform ? null_uniform_rest : null_deepest_rest;
  const std::size_t most = nulls.rows_to(rest);
  for (std::size_t i = 0; i < most; ++i) {
    for (std::size_t j = 0; j < foci; ++j) {
      scratch.heard[i * foci + j] = product(nulls.rows(), i, scratch.asked, j);
      scratch.across[i * foci + j] = inner_product(nulls.rows(), i, scratch.sounds, j);
    }
  }
  std::size_t rows = most;
  const double keeps = constraint == Constraint::uniform ? null_keeps_uniform : null_keeps;
  while (without_rows(matrix, rows, scratch) < keeps && rest < null_loosest_rest) {
    rest = std::min(rest * looser, null_loosest_rest);
    rows = nulls.rows_to(rest);
  }
  const std::size_t centres = nulls.rows_to(1);  // and places alone
  while (rows > centres && without_rows(matrix, rows, scratch) < null_keeps)
    --rows;
  return rows;
}

/// Replaces `sums` by B' times factors.
template <typename FactorOf>
void add_up(const Nulls& nulls, std::size_t rows, FactorOf factor_of, NullScratch& scratch) {
  const std::size_t foci = scratch.asked.rows;
  scratch.sums.reset(1, scratch.asked.transducers);
  for (std::size_t j = 0; j < foci; ++j)
    add_row(factor_of(j), scratch.asked, j, scratch.sums, 0);
  for (std::size_t i = 0; i < rows; ++i) {
    Complex heard = 0;
    for (std::size_t j = 0; j < foci; ++j)
      heard += scratch.heard[i * foci + j] * factor_of(j);
    add_conjugate(-heard, nulls.rows(), i, scratch.sums, 0);
  }
}

void find_weights(const Columns& columns, std::span<const double> gains, std::span<FocusWeight> weights,
                  GsPatScratch& gs_pat_scratch, NullScratch& scratch) {
  const std::size_t foci = columns.foci;
  if (foci > 1 && foci <= most_solved_foci) {
    // The factors are found for amplitudes in proportion; silent_phases makes them even under other constraints.
    gs_pat(scratch.matrix, columns, gains, Constraint::normalise, weights, gs_pat_scratch);
    scratch.targets.resize(foci);
    for (std::size_t j = 0; j < foci; ++j)
      scratch.targets[j] = gains[j] * gs_pat_scratch.claims[j];
    return;
  }
  for (std::size_t j = 0; j < foci; ++j)
    weights[j] = {.plain = 1, .heard = gains[j]};
  scratch.targets.assign(gains.begin(), gains.end());
}

/// The pressure of the weakest focus, relative to its target.
double loudness_of_weakest(std::span<const Complex> sums, NullScratch& scratch) {
  scratch.sums.reset(1, sums.size());
  for (std::size_t n = 0; n < sums.size(); ++n) {
    scratch.sums.re[n] = sums[n].real();
    scratch.sums.im[n] = sums[n].imag();
  }
  return weakest_of(scratch.targets,
                    [&](std::size_t j) { return magnitude(product(scratch.sounds, j, scratch.sums, 0)); });
}

/// Replaces `sums` by what is asked for one focus without nulls, as the constraint has it. Returns its pressure.
double loudness_alone(Constraint constraint, std::span<Complex> sums, NullScratch& scratch) {
  double largest = 1;
  for (std::size_t n = 0; n < sums.size(); ++n)
    sums[n] = bounded(scratch.asked.at(0, n), constraint);
  if (constraint == Constraint::normalise) largest = largest_of(scratch.asked, 0);
  return largest > 0 ? loudness_of_weakest(sums, scratch) / largest : 0;
}

/// What makes a drive of some rows, and how loud one focus is without nulls.
struct Making {
  const Nulls& nulls;
  std::span<const double> gains;
  Constraint constraint;
  std::span<const FocusWeight> weights;
  double alone;
};

/// Replaces scratch.sums by a drive that is played in proportion. Returns its largest magnitude.
template <typename FactorOf>
double add_up_evenly(const Making& making, std::size_t rows, FactorOf factor_of, NullScratch& scratch) {
  add_up(making.nulls, rows, factor_of, scratch);
  if (making.gains.size() == 1) {
    const double largest = largest_of(scratch.sums, 0);
    if (magnitude(product(scratch.sounds, 0, scratch.sums, 0)) >= null_one_lowers * making.alone * largest)
      return largest;
  }
  return lower_peaks(scratch.sounds, making.nulls.rows(), rows, scratch.sums, scratch.peaks);
}

/// Replaces `sums`. Returns as sum_with_nulls.
double make_drive(const Making& making, std::size_t rows, std::span<Complex> sums, NullScratch& scratch) {
  const auto plain = [&](std::size_t j) { return making.weights[j].plain; };
  const auto heard = [&](std::size_t j) { return making.weights[j].heard; };
  if (making.constraint == Constraint::normalise) {
    const bool differ = std::ranges::any_of(making.gains, [](double gain) { return gain != 1; });
    const double largest = differ ? add_up_evenly(making, rows, plain, scratch) : 0;
    const double own = add_up_evenly(making, rows, heard, scratch);
    for (std::size_t n = 0; n < sums.size(); ++n)
      sums[n] = scratch.sums.at(0, n);
    return std::max(largest, own);
  }
  add_up(making.nulls, rows, heard, scratch);
  for (std::size_t n = 0; n < sums.size(); ++n)
    sums[n] = bounded(scratch.sums.at(0, n), Constraint::uniform);
  silent_phases({scratch.sounds, scratch.targets, making.nulls.rows(), rows, making.nulls.loudness()}, sums,
                scratch.silent);
  return 1;
}

}  // namespace

void reserve(NullScratch& scratch, const Nulls& nulls, std::size_t most_foci) {
  const std::size_t foci = std::min(most_foci, most_solved_foci);
  const std::size_t rows = nulls.rows().rows, stride = nulls.rows().stride, all = foci + rows;
  const auto make_room = [&](SplitRows& split, std::size_t count) {
    split.re.reserve(count * stride);
    split.im.reserve(count * stride);
  };
  make_room(scratch.sounds, foci);
  make_room(scratch.asked, foci);
  make_room(scratch.sums, 1);
  scratch.heard.reserve(rows * foci);
  scratch.across.reserve(rows * foci);
  scratch.matrix.re.reserve(foci * foci);
  scratch.matrix.im.reserve(foci * foci);
  scratch.own.re.reserve(1);
  scratch.own.im.reserve(1);
  scratch.targets.reserve(foci);
  SilentScratch& silent = scratch.silent;
  for (PhasedSounds* sounds : {&silent.now, &silent.tried, &silent.kept}) {
    const std::size_t most = sounds == &silent.kept ? std::min(all, silent_raised_rows) : all;
    make_room(sounds->waves, most);
    sounds->re.reserve(stride);
    sounds->im.reserve(stride);
    sounds->sounds.reserve(most);
  }
  make_room(scratch.peaks.apart, foci);
  make_room(scratch.peaks.next, 1);
  for (std::vector<Complex>* values : {&scratch.peaks.kept, &scratch.peaks.missing})
    values->reserve(foci);
  for (std::vector<Complex>* values : {&scratch.peaks.products, &scratch.peaks.system})
    values->reserve(foci * foci);
  scratch.rounding.size.reserve(stride);
  scratch.rounding.turns.reserve(stride);
  silent.products.reserve(2 * all * (all + 1));
  silent.along.reserve(all);
  silent.across.reserve(all);
  silent.normal.reserve((foci + 2 * rows) * (foci + 2 * rows));
  silent.rest.reserve(foci + 2 * rows);
  silent.mean.reserve(foci + 2 * rows);
}

double sum_with_nulls(const Nulls& nulls, const Columns& columns, const FocusMatrix& matrix,
                      std::span<const double> gains, Constraint constraint, std::span<FocusWeight> weights,
                      std::span<Complex> sums, GsPatScratch& gs_pat_scratch, NullScratch& scratch) {
  assert(sums.size() == columns.transducers && gains.size() == columns.foci && weights.size() == columns.foci);
  split_sounds(columns, scratch.sounds);
  split_asked(columns, scratch.asked);
  const bool one = columns.foci == 1;
  // The loudest drives that are silent at the nulls have full amplitudes.
  const Constraint within = constraint == Constraint::clamp ? Constraint::uniform : constraint;
  const bool asks_own = one && within == Constraint::uniform;
  if (asks_own) ask_own_sound(scratch);
  std::size_t rows = choose_rows(nulls, asks_own ? scratch.own : matrix, within, scratch);
  find_weights(columns, gains, weights, gs_pat_scratch, scratch);
  const Making making{nulls, gains, within, weights, one ? loudness_alone(within, sums, scratch) : 0};
  const std::size_t centres = nulls.rows_to(1);
  double largest = make_drive(making, rows, sums, scratch);
  double weakest = loudness_of_weakest(sums, scratch);
  while (one && rows > centres && weakest < null_one_keeps * making.alone * largest) {
    rows = std::max(centres, rows * 7 / 8);
    largest = make_drive(making, rows, sums, scratch);
    weakest = loudness_of_weakest(sums, scratch);
  }
  choose_common_phase(nulls.centres(), weakest, sums, scratch.rounding);
  return largest;
}

}  // namespace palpa::array
