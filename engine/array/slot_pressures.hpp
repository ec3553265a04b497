// The foci of one slot with the pressures that they are to have, whatever they do to each other.
//
//   T_j  what focus j is to have, in 1/m: pascals over the layout's source level
//   R    the matrix of gs_pat.hpp: R c is what the foci hear of the factors c
//
//   |R c|_j = T_j, within pressure_miss
//
// By `naive` the factors begin as if each focus sounded alone, c_j = T_j / R_jj: the paper's q_j, in its phases.
// `gs_pat` chooses phases in which the foci help each other, as loud as asked relative to each other, and is scaled to
// all of it. From there even_out.hpp goes the rest of the way. A focus whose T_j is 0 sounds as it comes, and one of
// which nothing arrives is left out. Foci that are one to the array (gs_pat_same) have the largest of their T_j.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/even_out.hpp"
#include "array/gs_pat.hpp"
#include "array/transfer.hpp"

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

/// The phases in which foci begin: the paper's, or those in which they help each other (`gs_pat`).
enum class FocusPhases { own, helping };

/// Fills `factors` from nothing: as the foci begin. At most most_solved_foci foci.
void start_pressures(const FocusMatrix& matrix, const Columns& columns, FocusPhases phases,
                     std::span<const double> targets, std::span<std::complex<double>> factors,
                     PressureScratch& scratch);

/// Moves factors that are nearly there.
void correct_pressures(const FocusMatrix& matrix, std::span<const double> targets,
                       std::span<std::complex<double>> factors, PressureScratch& scratch);

}  // namespace palpa::array
