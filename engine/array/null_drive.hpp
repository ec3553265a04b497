// The drive of a slot's foci that is silent at nulls (nulls.hpp).
//
//   B, R    each focus' q_j as a column, and the matrix of gs_pat.hpp, R = G B
//   B'      B - Q^H Q B: what each focus asks for, without the part that is heard at the nulls; R' = G B'
//   c       the factors that gs_pat finds for R'; the sums of the transducers are B' c
//
// Under `normalise` that is the drive; with several foci, lower_peaks.hpp then lowers its loudest transducers. Under
// `uniform` and `clamp` the constraint changes the sums, and silent_phases.hpp silences the nulls again. At last,
// common_phase.hpp turns the whole drive to where boards round it best.
//
// Balls: the rows of Q down to a rest. The rest is null_deepest_rest, under `uniform` null_uniform_rest, and larger, up
// to null_loosest_rest, while some focus would keep less than null_keeps of its power, R'_jj < null_keeps R_jj (under
// `uniform` null_keeps_uniform). If one then still keeps less than null_keeps, further rows are left out one by one,
// but never centres.
//
// Under `normalise`, one focus also keeps null_keeps of the power that it has without nulls: the last rows are left
// out, but never centres.
//
// Under `clamp` with several foci, silencing may cost half of the loudness, because the drive is far from even
// amplitudes. If the weakest focus keeps less than null_clamp_keeps of its pressure, the same phases at full amplitude
// are silenced, too, and the louder drive is taken. With one focus, the drive is that of `uniform`.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/nulls.hpp"
#include "array/solvers/common_phase.hpp"
#include "array/solvers/gs_pat.hpp"
#include "array/solvers/lower_peaks.hpp"
#include "array/solvers/silent_phases.hpp"
#include "array/split_rows.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double null_uniform_rest = 3e-3;
inline constexpr double null_keeps = 0.25, null_keeps_uniform = 0.5;
inline constexpr double null_clamp_keeps = 0.75;

/// Keeps its storage from call to call.
struct NullScratch {
  SplitRows sounds, asked;                          ///< G and B of the foci
  std::vector<std::complex<double>> heard, across;  ///< Q B and Q G^H, [row * foci + focus]
  FocusMatrix matrix, own;                          ///< R', and R of a focus that asks for its own sound
  std::vector<double> targets;
  SplitRows sums;
  std::vector<std::complex<double>> other;  ///< another drive, from an even start
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
