// The drive of a slot's foci that is silent at nulls (nulls.hpp).
//
//   B, R    each focus' q_j as a column, and the matrix of gs_pat.hpp, R = G B
//   B'      B - Q^H Q B: what each focus asks for, without the part that is heard at the nulls; R' = G B'
//   c       the factors that gs_pat finds for R'; the sums of the transducers are B' c
//
// Under `normalise` that is the drive; with several foci, lower_peaks.hpp then lowers its loudest transducers. Under
// `uniform` and `clamp` the sums get full amplitudes, and silent_phases.hpp silences the nulls again: of all drives
// with amplitudes up to 1 that are silent at the nulls, the loudest have full amplitudes, so `clamp` has nothing to
// limit. At last, common_phase.hpp turns the whole drive to where boards round it best.
//
// Balls: the rows of Q down to a rest. The rest is null_deepest_rest, under `uniform` and `clamp` null_uniform_rest,
// and larger, up to null_loosest_rest, while some focus would keep less than null_keeps of its power, R'_jj <
// null_keeps R_jj (under `uniform` and `clamp` null_keeps_uniform). If one then still keeps less than null_keeps,
// further rows are left out one by one, but never centres.
//
// One focus under `normalise`: if it keeps less than null_one_lowers of the pressure that it has without nulls,
// lower_peaks.hpp lowers its loudest transducers, too. One focus under any constraint: while it keeps less than
// null_one_keeps of that pressure, the last eighth of the rows is left out, but never centres.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/amplitudes.hpp"
#include "array/field/split_rows.hpp"
#include "array/field/transfer.hpp"
#include "array/nulls/nulls.hpp"
#include "array/solvers/common_phase.hpp"
#include "array/solvers/gs_pat.hpp"
#include "array/solvers/lower_peaks.hpp"
#include "array/solvers/silent_phases.hpp"

namespace palpa::array {

inline constexpr double null_uniform_rest = 3e-3;
inline constexpr double null_keeps = 0.25, null_keeps_uniform = 0.5;    // of power
inline constexpr double null_one_lowers = 0.89, null_one_keeps = 0.75;  // of pressure

/// Keeps its storage from call to call.
struct NullScratch {
  SplitRows sounds, asked;                          ///< G and B of the foci
  std::vector<std::complex<double>> heard, across;  ///< Q B and Q G^H, [row * foci + focus]
  FocusMatrix matrix, own;                          ///< R', and R of a focus that asks for its own sound
  std::vector<double> targets;
  SplitRows sums;
  SilentScratch silent;
  RoundingScratch rounding;
  PeakScratch peaks;
};

/// Reserves memory for `most_foci` foci, at most most_solved_foci.
void reserve(NullScratch& scratch, const Nulls& nulls, std::size_t most_foci);

/// Replaces `sums`, one per transducer, by a drive for the foci of `columns`. Returns the largest magnitude of these
/// sums and those without gains; 1 under `uniform` and `clamp`, where no sum is larger. `matrix` is R; `gains` are
/// relative to the largest. `weights`, one per focus, become c. Above most_solved_foci foci, c are the gains.
double sum_with_nulls(const Nulls& nulls, const Columns& columns, const FocusMatrix& matrix,
                      std::span<const double> gains, Constraint constraint, std::span<FocusWeight> weights,
                      std::span<std::complex<double>> sums, GsPatScratch& gs_pat_scratch, NullScratch& scratch);

}  // namespace palpa::array
