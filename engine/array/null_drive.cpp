#include "array/null_drive.hpp"

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

/// How loud a drive of one focus is if it is played in proportion.
double loudness_in_proportion(const SplitRows& sums, const NullScratch& scratch) {
  const double largest = largest_of(sums, 0);
  return largest > 0 ? magnitude(product(scratch.sounds, 0, sums, 0)) / largest : 0;
}

/// Fewer rows, so that the drive of one focus, which is played in proportion, keeps its share of pressure: silence
/// raises the amplitudes of a few transducers, and all others are then lowered. Never fewer than those of centres.
std::size_t give_way(const Nulls& nulls, std::size_t rows, NullScratch& scratch) {
  const double least = std::sqrt(null_keeps) * loudness_in_proportion(scratch.asked, scratch);
  const std::size_t centres = nulls.rows_to(1);
  add_up(
      nulls, rows, [](std::size_t) { return Complex(1); }, scratch);
  while (rows > centres && loudness_in_proportion(scratch.sums, scratch) < least) {
    --rows;
    add_conjugate(scratch.heard[rows], nulls.rows(), rows, scratch.sums, 0);
  }
  return rows;
}

/// The same for a drive that is played in proportion: with several foci, its loudest transducers are lowered. Returns
/// the largest magnitude.
template <typename FactorOf>
double add_up_evenly(const Nulls& nulls, std::size_t rows, FactorOf factor_of, NullScratch& scratch) {
  add_up(nulls, rows, factor_of, scratch);
  if (scratch.sounds.rows == 1) return largest_of(scratch.sums, 0);
  return lower_peaks(scratch.sounds, nulls.rows(), rows, scratch.sums, scratch.peaks);
}

void find_weights(const Columns& columns, std::span<const double> gains, std::span<FocusWeight> weights,
                  GsPatScratch& gs_pat_scratch, NullScratch& scratch) {
  const std::size_t foci = columns.foci;
  if (foci > 1 && foci <= most_solved_foci) {
    // The factors are found for amplitudes in proportion; silent_phases makes them even under other constraints.
    gs_pat(scratch.matrix, columns, gains, Constraint::normalise, Care::usual, weights, gs_pat_scratch);
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

/// Brings the sums within the constraint, as loud as gs_pat would.
void bound(Constraint constraint, std::span<Complex> sums) {
  double scale = 1;
  if (constraint == Constraint::clamp) {
    double total = 0;
    for (const Complex& sum : sums)
      total += magnitude(sum);
    scale = total > 0 ? gs_pat_fill * static_cast<double>(sums.size()) / total : 1;
  }
  for (Complex& sum : sums)
    sum = bounded(sum * scale, constraint);
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
  scratch.other.reserve(stride);
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
  // With one focus, `clamp` is as `uniform`: of all drives with silent rows, the loudest has full amplitudes.
  const Constraint within = constraint == Constraint::clamp && columns.foci == 1 ? Constraint::uniform : constraint;
  const bool asks_own = within == Constraint::uniform && columns.foci == 1;
  if (asks_own) ask_own_sound(scratch);
  std::size_t rows = choose_rows(nulls, asks_own ? scratch.own : matrix, within, scratch);
  if (constraint == Constraint::normalise && columns.foci == 1) rows = give_way(nulls, rows, scratch);
  find_weights(columns, gains, weights, gs_pat_scratch, scratch);
  const auto plain = [&](std::size_t j) { return weights[j].plain; };
  const auto heard = [&](std::size_t j) { return weights[j].heard; };
  double largest = 1;
  if (constraint == Constraint::normalise) {
    const bool differ = std::ranges::any_of(gains, [](double gain) { return gain != 1; });
    largest = differ ? add_up_evenly(nulls, rows, plain, scratch) : 0;
    largest = std::max(largest, add_up_evenly(nulls, rows, heard, scratch));
  } else {
    add_up(nulls, rows, heard, scratch);
  }
  for (std::size_t n = 0; n < sums.size(); ++n)
    sums[n] = scratch.sums.at(0, n);
  double weakest = 0;
  if (constraint == Constraint::normalise) {
    weakest = loudness_of_weakest(sums, scratch);
  } else {
    const SilentGoal goal{scratch.sounds, scratch.targets, nulls.rows(), rows, nulls.loudness()};
    scratch.other.assign(sums.begin(), sums.end());
    bound(within, sums);
    const double before = loudness_of_weakest(sums, scratch);
    const Silenced silenced = silent_phases(goal, sums, scratch.silent);
    weakest = loudness_of_weakest(sums, scratch);
    if (within == Constraint::clamp && weakest < null_clamp_keeps * before) {
      bound(Constraint::uniform, scratch.other);
      const double depth = silent_phases(goal, scratch.other, scratch.silent).depth;
      const double loud = loudness_of_weakest(scratch.other, scratch);
      if (loud > weakest && depth <= std::max(silent_depth, silenced.depth)) {
        std::ranges::copy(scratch.other, sums.begin());
        weakest = loud;
      }
    }
  }
  choose_common_phase(nulls.centres(), weakest, sums, scratch.rounding);
  return largest;
}

}  // namespace palpa::array
