// Iterative back-propagation: Gerchberg and Saxton's steps over the whole array, without weights.
//
// After Marzo and Drinkwater, "Holographic acoustic tweezers", PNAS 116(1) 2019.
//
//   p = G P(B c),  c_j = t_j p_j / |p_j|
//
// G, B and t are those of gs_pat.hpp, P the constraint. The phases climb until the foci help each other, but nothing
// evens them out: a focus may stay far weaker than others. As published, it starts once. Half of the sets and more end
// at the limit of steps.
//
// Twin: shaders/array/solve/solve_weights.comp and solve_refine.comp with `weighs` = 0.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/amplitudes.hpp"
#include "array/field/transfer.hpp"

namespace palpa::array {

inline constexpr std::uint32_t propagation_steps = 100;  ///< at most
inline constexpr double propagation_still = 1e-5;        ///< stops once no factor moves by more, except with all others

/// Fills `factors`, one per focus, beginning with the phases of a sound that converges on the first transducer.
/// `gains` are relative to the largest, 0..1. `pressure` is working memory. At most most_solved_foci foci.
void propagated_factors(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains,
                        Constraint constraint, std::span<std::complex<double>> factors,
                        std::vector<std::complex<double>>& pressure);

}  // namespace palpa::array
