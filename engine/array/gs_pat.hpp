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
// for that much only, so that it does not take the array from the others.
//
// Foci near each other. r_jk = |R_jk| / sqrt(R_jj R_kk) is what part of focus k's sound is heard at focus j. From
// gs_pat_crowded on the array does not resolve the two, and from gs_pat_same on they become one: a focus is asked to be
// at least as loud as its nearest neighbours' gains make it, so that at one place the largest gain wins. Where no pair
// hears gs_pat_hears of each other, one start will do, its phases as if the sound came from the first transducer. Where
// some do, the phases have many places to climb to, and gs_pat_starts starts are tried; taken is that with the weakest
// focus the loudest for the power that it takes. The others begin with the phases of what gs_pat_sounds other
// transducers sound like together: from one alone they would change little within a ring, and those which run once
// around it, often the best, would never be found.
//
// The steps end near what is even; even_out.hpp goes the rest of the way on R. Under `uniform` and `clamp` a transducer
// does not do its sum of B c but what the constraint makes of it, so that few tries on R will do, and more of them make
// foci weaker that are near each other; from there on even_phases.hpp turns the transducers
// until what is even is what they sound like, amplitudes being what they are. Under `clamp` the factors are scaled
// first, so that the sums are gs_pat_fill times as large as those of foci that do not hear each other.
//
// That is for up to gs_pat_few foci. More of them are not evened out so: v_j never exceeds gs_pat_most_weight, and
// under `uniform` and `clamp` the same step is repeated gs_pat_refinings times over the whole array, p = G P(B c) with
// P the constraint.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/even_out.hpp"
#include "array/even_phases.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double gs_pat_most_weight = 4;       ///< their mean is 1
inline constexpr double gs_pat_most_help = 4;         ///< for a focus that is hard to reach
inline constexpr std::uint32_t gs_pat_steps = 100;    ///< at most, for the plain factors; as many again for the gains
inline constexpr double gs_pat_still = 1e-5;          ///< stops where no factor moves more
inline constexpr std::uint32_t gs_pat_refinings = 6;  ///< over the whole array, under `uniform` and `clamp`
inline constexpr std::size_t gs_pat_few = 10;

inline constexpr double gs_pat_crowded = 0.5;
inline constexpr double gs_pat_same = 0.9;
inline constexpr double gs_pat_hears = 0.2;
inline constexpr std::uint32_t gs_pat_starts = 8;         ///< where foci hear each other
inline constexpr std::uint32_t gs_pat_sounds = 4;         ///< transducers of each of them but the first
inline constexpr std::uint32_t gs_pat_climb = 20;         ///< steps of each of them
inline constexpr std::uint32_t gs_pat_look = 3;           ///< tries to even it out before it is judged
inline constexpr double gs_pat_better = 1.005;            ///< by so much a later start has to be
inline constexpr double gs_pat_miss = 0.003;              ///< no focus misses by more
inline constexpr double gs_pat_fill = 2;                  ///< under `clamp`
inline constexpr std::uint32_t gs_pat_tries = 40;         ///< of even_out,
inline constexpr std::uint32_t gs_pat_bounded_tries = 8;  ///< or where even_phases goes on
inline constexpr std::uint32_t gs_pat_phase_tries = 60;   ///< of even_phases

/// gs_pat_phase_tries, or how many fit: a software device ends the loops of a shader after 65,535 iterations.
std::uint32_t gs_pat_most_tries(std::size_t transducers);

/// Keeps its storage from call to call.
struct GsPatScratch {
  std::vector<std::complex<double>> pressure, factors, start;
  std::vector<double> claims, targets;
  EvenScratch even;
  PhaseScratch phases;
};

/// What part of the sound of focus `k` is heard at focus `j`, 0 .. 1; 0 where one of them cannot be reached.
double heard_part(const FocusMatrix& matrix, std::size_t j, std::size_t k);

/// Fills `weights`, one per focus, from R and, where the constraint bounds amplitudes, all columns. `gains` are
/// relative to the largest, 0..1, one per focus. At most most_solved_foci foci. Starts from phases that hang on
/// distances alone, so that a motion of array and foci together or another order of the foci changes nothing but
/// rounding.
void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            std::span<FocusWeight> weights, GsPatScratch& scratch);

/// Under `uniform` and `clamp`, for the slot that `scratch` was last in gs_pat for: bounds the sums of the transducers,
/// B c of the heard factors, and turns them until the foci are even. Leaves sums of more foci than gs_pat_few.
void gs_pat_turn(const Columns& columns, Constraint constraint, std::span<std::complex<double>> sums,
                 GsPatScratch& scratch);

}  // namespace palpa::array
