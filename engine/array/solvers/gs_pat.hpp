// Gerchberg-Saxton on the small matrix R = G B: weights for the foci of a slot so that each is as loud as requested.
// After Plasencia et al., "GS-PAT", ACM Trans. Graph. 39(4) 2020, and Di Leonardo et al., Optics Express 15(4) 2007.
//
//   G        the pressure at focus m from transducer n at full amplitude: D e^{ikr} / r
//   B        column j: q_j, the drive for focus j, so that a total drive is B c
//   R = G B  the pressure at focus m from the drive for focus j: as many rows as foci
//   c_j      the factor of q_j, a real weight v_j times a phase
//   t_j      target loudness of focus j: its relative gain, times min(1, 4 R_jj / max R)
//
//   p = R c;  phase of c_j <- phase of p_j;  v_j <- v_j t_j L / |p_j|,  L = sum |p| / sum t
//
// docs/notes/gs-pat.md has all steps and their reasons: gains, foci near each other, bounded amplitudes, loud phases.
//
// Few foci (gs_pat_few.cpp) and many (gs_pat.cpp) have a method each, and each method is written twice, for the host
// and for the device (solve_weights_few.comp, solve_weights.comp):
// - With the climb alone, the method for many, the weakest focus of a ring in `paper` is at worst 0.40 times as loud as
//   the loudest; with that for few, 0.995 times. Its kernel keeps the matrix and the normal equations in a thread's
//   registers, which do not hold those of many foci.
// - The host computes in doubles, and its results are the reference for the kernels. These compute in floats, which
//   differ by up to 3e-5 of a full amplitude, a slot per thread or a row per thread, in loops without branches. In one
//   source, one of the two would have the arithmetic of the other: drives would change, or be slower.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/amplitudes.hpp"
#include "array/field/transfer.hpp"
#include "array/solvers/even_out.hpp"
#include "array/solvers/even_phases.hpp"

namespace palpa::array {

inline constexpr double gs_pat_most_weight = 4;       ///< of v_j for more than gs_pat_few foci; their mean is 1
inline constexpr double gs_pat_most_help = 4;         ///< the 4 in t_j: for a focus that is hard to reach
inline constexpr std::uint32_t gs_pat_steps = 100;    ///< maximum for the plain factors; as many again for the gains
inline constexpr double gs_pat_still = 1e-5;          ///< stops once no factor changes by more
inline constexpr std::uint32_t gs_pat_refinings = 6;  ///< over the whole array, under `uniform` and `clamp`
inline constexpr std::size_t gs_pat_few = 10;         ///< up to this many foci are evened out after the steps

// Limits of heard_part().
inline constexpr double gs_pat_crowded = 0.5;  ///< from here on, the array does not resolve the two foci
inline constexpr double gs_pat_same = 0.9;     ///< from here on, their targets become one: the largest
inline constexpr double gs_pat_hears = 0.2;    ///< from here on, several starts are tried

inline constexpr std::uint32_t gs_pat_starts = 8;         ///< if foci hear each other
inline constexpr std::uint32_t gs_pat_sounds = 4;         ///< transducers of each start except the first
inline constexpr std::uint32_t gs_pat_climb = 20;         ///< steps of each start
inline constexpr std::uint32_t gs_pat_look = 3;           ///< tries to even a start out before it is judged
inline constexpr double gs_pat_better = 1.005;            ///< minimum improvement for a later start
inline constexpr double gs_pat_miss = 0.003;              ///< stops once no focus misses by more
inline constexpr double gs_pat_fill = 2;                  ///< of the sums, under `clamp`: times those of foci alone
inline constexpr std::uint32_t gs_pat_tries = 40;         ///< of even_out,
inline constexpr std::uint32_t gs_pat_bounded_tries = 8;  ///< or if even_phases follows
inline constexpr std::uint32_t gs_pat_phase_tries = 60;   ///< of even_phases

/// gs_pat_phase_tries, or fewer if they do not fit: a software device ends the loops of a shader after 65,535
/// iterations.
std::uint32_t gs_pat_most_tries(std::size_t transducers);

/// Keeps its storage from call to call.
struct GsPatScratch {
  std::vector<std::complex<double>> pressure, factors, start;
  std::vector<double> claims, targets;
  EvenScratch even;
  PhaseScratch phases;
};

/// The share of the sound of focus `k` that is heard at focus `j`, 0 .. 1; 0 if one of them cannot be reached.
double heard_part(const FocusMatrix& matrix, std::size_t j, std::size_t k);
/// Whether two foci hear at least this part of each other.
bool some_hear(const FocusMatrix& matrix, double least);

/// Fills `weights`, one per focus, from R and, if the constraint bounds amplitudes, from all columns. `gains` are
/// relative to the largest, 0..1, one per focus. At most most_solved_foci foci. The initial phases depend only on
/// distances, so moving array and foci together or reordering the foci changes only rounding.
void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            std::span<FocusWeight> weights, GsPatScratch& scratch);

/// Under `uniform` and `clamp`, for the slot for which `scratch` was last used in gs_pat: bounds the sums of the
/// transducers, B c of the heard factors, and changes their phases until the foci are even, or the weakest is as loud
/// as it gets. Does not change sums of more foci than these methods are for.
void gs_pat_turn(const Columns& columns, Constraint constraint, std::span<std::complex<double>> sums,
                 GsPatScratch& scratch);

}  // namespace palpa::array
