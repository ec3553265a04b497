// Solves the foci of one slot for given pressures, including the influence of the foci on each other.
//
//   T_j  the target of focus j, in 1/m: pascals over the layout's source level
//   R    the matrix of gs_pat.hpp: R c are the pressures at the foci for the factors c
//
//   |R c|_j = T_j, within pressure_miss
//
// With `naive`, the factors start as if each focus sounded alone, c_j = T_j / R_jj: the paper's q_j, in its phases.
// `gs_pat` chooses phases in which the foci help each other, as loud as requested relative to each other, and its
// result is scaled to the full targets. From there even_out.hpp finishes the work. A focus whose T_j is 0 is not
// corrected, and one at which nothing arrives is left out. Foci that the array cannot separate (gs_pat_same) get the
// largest of their T_j.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"
#include "array/solvers/even_out.hpp"
#include "array/solvers/gs_pat.hpp"

namespace palpa::array {

inline constexpr double pressure_miss = 1e-3;
inline constexpr std::uint32_t pressure_tries = 40;

/// Keeps its storage from call to call.
struct PressureScratch {
  GsPatScratch gs_pat;
  EvenScratch even;
  std::vector<double> gains, targets;
  std::vector<FocusWeight> weights;
};

/// The initial phases of foci: the paper's, or those in which they help each other (`gs_pat`).
enum class FocusPhases { own, helping };

/// Fills `factors` with the start values. At most most_solved_foci foci.
void start_pressures(const FocusMatrix& matrix, const Columns& columns, FocusPhases phases,
                     std::span<const double> targets, std::span<std::complex<double>> factors,
                     PressureScratch& scratch);

/// Corrects factors that are almost right.
void correct_pressures(const FocusMatrix& matrix, std::span<const double> targets,
                       std::span<std::complex<double>> factors, PressureScratch& scratch);

}  // namespace palpa::array
