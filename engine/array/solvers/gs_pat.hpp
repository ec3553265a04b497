// Gerchberg-Saxton on the small matrix R = G B: weights for the foci of a slot so that each is as loud as requested.
//
// After Plasencia et al., "GS-PAT: high-speed multi-point sound-fields for phased arrays of transducers", ACM Trans.
// Graph. 39(4) 2020, with the weights of Di Leonardo et al., Optics Express 15(4) 2007, which even out the foci.
//
//   G        the pressure at focus m from transducer n at full amplitude: D e^{ikr} / r
//   B        column j: q_j, the drive for focus j, so that a total drive is B c
//   R = G B  the pressure at focus m from the drive for focus j: as many rows as foci
//   c_j      the factor of q_j, a real weight v_j times a phase
//   t_j      target loudness of focus j: its relative gain, times min(1, 4 R_jj / max R)
//
//   p = R c;  phase of c_j <- phase of p_j;  v_j <- v_j t_j L / |p_j|,  L = sum |p| / sum t
//
// The phases climb towards those at which the foci help each other most; the weights even out the foci. The first run
// uses all t_j = 1 and gives the plain factors, whose mean magnitude is 1. If gains differ, a second run starts from
// there with t_j = the relative gains and the same L: a finger that becomes quiet leaves the others as loud as they
// are.
//
// Compare the loudness that each focus has alone. A focus that would be quieter than the loudest one even if it were
// four times as loud can hardly be reached. Its target is limited accordingly, so that it does not take the array away
// from the others.
//
// Foci near each other. r_jk = |R_jk| / sqrt(R_jj R_kk) is the share of focus k's sound that is heard at focus j. From
// gs_pat_crowded on, the array does not resolve the two, and from gs_pat_same on they become one: each focus' target is
// at least what its nearest neighbours' gains give there, so that at one place the largest gain wins. If no two foci
// hear each other, which means that r_jk is below gs_pat_hears for all pairs, a single start suffices, with phases as
// if the sound came from the first transducer. Otherwise the phases have many local optima, and gs_pat_starts starts
// are tried; the one with the loudest weakest focus for its power is taken. Each of the other starts takes the phases
// of the joint sound of gs_pat_sounds other transducers. The sound of only one would change little within a ring, and
// phases that run once around it, often the best, would never be found.
//
// The steps end when the foci are nearly even; even_out.hpp then finishes the work on R. Under `uniform` and `clamp`, a
// transducer does not play its sum of B c but the result of the constraint. Few tries on R suffice there, because more
// of them weaken foci that are near each other. After that, even_phases.hpp changes the phases of the transducers, with
// fixed amplitudes, until the actual pressures are even. Under `clamp` the factors are scaled first, so that the sums
// are gs_pat_fill times as large as those of foci that do not hear each other.
//
// This applies to up to gs_pat_few foci. More foci are not evened out this way: v_j never exceeds gs_pat_most_weight,
// and under `uniform` and `clamp` the same step is repeated gs_pat_refinings times over the whole array, p = G P(B c)
// with P the constraint.
//
// Loudness first. Foci near each other cannot always be both loud and even. Under `uniform` and `clamp`, up to
// most_searched_foci foci with an r_jk of gs_pat_near or more therefore get the phases with which the weakest is as
// loud as possible (search.hpp, climb.hpp). Only then the louder foci are lowered towards it, at little cost for the
// weakest. The solver `loudest` (Care::most) does the same with more effort for foci at any distance, from the factors
// above as one of many starts. Under these constraints, the steps above then only serve foci that do not hear each
// other.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/constraint.hpp"
#include "array/solvers/even_out.hpp"
#include "array/solvers/even_phases.hpp"
#include "array/solvers/search.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double gs_pat_most_weight = 4;       ///< their mean is 1
inline constexpr double gs_pat_most_help = 4;         ///< for a focus that is hard to reach
inline constexpr std::uint32_t gs_pat_steps = 100;    ///< maximum for the plain factors; the same number again for the
                                                      ///< gains
inline constexpr double gs_pat_still = 1e-5;          ///< stops once no factor changes by more
inline constexpr std::uint32_t gs_pat_refinings = 6;  ///< over the whole array, under `uniform` and `clamp`
inline constexpr std::size_t gs_pat_few = 10;

inline constexpr double gs_pat_crowded = 0.5;
inline constexpr double gs_pat_same = 0.9;
inline constexpr double gs_pat_hears = 0.2;
inline constexpr double gs_pat_near = 0.05;               ///< of such foci, the loudest phases are sought
inline constexpr std::size_t gs_pat_ears = 128;           ///< transducers that judge it before a search
inline constexpr std::uint32_t gs_pat_starts = 8;         ///< if foci hear each other
inline constexpr std::uint32_t gs_pat_sounds = 4;         ///< transducers of each start except the first
inline constexpr std::uint32_t gs_pat_climb = 20;         ///< steps of each start
inline constexpr std::uint32_t gs_pat_look = 3;           ///< tries to even a start out before it is judged
inline constexpr double gs_pat_better = 1.005;            ///< minimum improvement for a later start
inline constexpr double gs_pat_miss = 0.003;              ///< stops once no focus misses by more
inline constexpr double gs_pat_fill = 2;                  ///< under `clamp`
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
  SearchScratch search;
  ClimbScratch climb;
  std::vector<double> shares;
  FocusMatrix near;
  const SearchEffort* effort =
      nullptr;  ///< with which the slot's factors were sought (search.hpp); null: they were not
};

/// How much is done for loudness: `most` is the solver `loudest`.
enum class Care { usual, most };

/// Whether some foci hear gs_pat_near of each other. `part` has the columns of gs_pat_ears transducers (take_part).
bool are_near(const Columns& part, FocusMatrix& scratch);

/// How the phases of a slot of so many foci are sought; null: they are not. `near` tells whether foci are near each
/// other.
template <typename Near>
const SearchEffort* effort_for(Care care, Constraint constraint, std::size_t foci, Near near) {
  if (constraint == Constraint::normalise || foci < 2 || foci > most_searched_foci) return nullptr;
  if (care == Care::most) return &loudest_search;
  if (!near()) return nullptr;
  return foci <= gs_pat_few ? &usual_search : &many_search;
}

/// The share of the sound of focus `k` that is heard at focus `j`, 0 .. 1; 0 if one of them cannot be reached.
double heard_part(const FocusMatrix& matrix, std::size_t j, std::size_t k);

/// Fills `weights`, one per focus, from R and, if the constraint bounds amplitudes, from all columns. `gains` are
/// relative to the largest, 0..1, one per focus. At most most_solved_foci foci. The initial phases depend only on
/// distances, so moving array and foci together or reordering the foci changes only rounding.
void gs_pat(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
            Care care, std::span<FocusWeight> weights, GsPatScratch& scratch);

/// Under `uniform` and `clamp`, for the slot for which `scratch` was last used in gs_pat: bounds the sums of the
/// transducers, B c of the heard factors, and changes their phases until the foci are even, or the weakest is as loud
/// as it gets. Does not change sums of more foci than these methods are for.
void gs_pat_turn(const Columns& columns, Constraint constraint, std::span<std::complex<double>> sums,
                 GsPatScratch& scratch);

}  // namespace palpa::array
