// Gerchberg-Saxton on the small matrix R = G B: how to weigh the foci of a slot so that each is as loud as asked.
//
// After Plasencia et al., "GS-PAT: high-speed multi-point sound-fields for phased arrays of transducers", ACM Trans.
// Graph. 39(4) 2020, with the weights of Di Leonardo et al., Optics Express 15(4) 2007, which even the foci out.
//
//   G        what arrives at focus m of transducer n at full amplitude: D e^{ikr} / r
//   B        column j: q_j, what focus j asks of the transducers, so that a drive is B c
//   R = G B  what arrives at focus m of what focus j asks: as many rows as foci
//   c_j      the factor of q_j, a real weight v_j times a phase
//   t_j      how loud focus j is to be: its relative gain, times min(1, 4 R_jj / max R)
//
//   p = R c;  phase of c_j <- phase of p_j;  v_j <- v_j t_j L / |p_j|,  L = sum |p| / sum t
//
// The phases climb towards those at which the foci help each other the most; the weights even them out. First for all
// t_j = 1: the plain factors, their mean magnitude 1. Where gains differ, once more from there with t_j = the relative
// gains and L kept as it was: a finger that grows quiet leaves the others as loud as they are.
//
// A focus that alone, four times as loud, is not as loud as the loudest one alone can hardly be reached: it is asked
// for that much only, so that it does not take the array from the others. Foci at one place share what they ask; of
// several gains there the largest wins. No v_j exceeds gs_pat_most_weight.
//
// Under `uniform` and `clamp` the amplitudes of a drive are not those of B c. There the same step is repeated over the
// whole array, p = G P(B c) with P the constraint, so that what is even is what sounds. The weights then go half the
// way (the root of the ratio): of two foci that share phases alone, the one a little ahead takes nearly all.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double gs_pat_most_weight = 4;       ///< their mean is 1
inline constexpr double gs_pat_most_help = 4;         ///< for a focus that is hard to reach
inline constexpr std::uint32_t gs_pat_steps = 100;    ///< at most, for the plain factors; as many again for the gains
inline constexpr double gs_pat_still = 1e-5;          ///< stops where no factor moves more
inline constexpr std::uint32_t gs_pat_refinings = 6;  ///< over the whole array, under `uniform` and `clamp`
inline constexpr std::size_t gs_pat_few = 3;

/// Keeps its storage from call to call.
struct GsPatScratch {
  std::vector<std::complex<double>> pressure;
  std::vector<double> claims, targets;
};

/// Fills `weights`, one per focus, from R and, where the constraint bounds amplitudes, all columns. `gains` are
/// relative to the largest, 0..1, one per focus. At most most_solved_foci foci. Starts from phases that hang on
/// distances alone, so that a motion of array and foci together or another order of the foci changes nothing but
/// rounding.
void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            std::span<FocusWeight> weights, GsPatScratch& scratch);

}  // namespace palpa::array
