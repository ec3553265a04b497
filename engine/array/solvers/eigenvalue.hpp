// Long's method: phases of the foci from an eigenvector, then the factors that give every focus its loudness.
//
// After Long et al., "Rendering volumetric haptic shapes in mid-air using ultrasound", ACM Trans. Graph. 33(6) 2014.
//
//   M_jk = t_k R_jk / R_kk   what is heard at focus j if focus k is driven alone until it is as loud as wanted
//   v                        the eigenvector of M with the largest eigenvalue, by repeated products; if the second
//                            eigenvalue is within 1 % of it, the products end before they reach it
//   b_j = t_j v_j / |v_j|    (R / mean R_jj + ridge) c = b
//
// R, c and t are those of gs_pat.hpp. The ridge is Tikhonov's: foci that the array does not resolve would otherwise ask
// for factors without bound. Sums are then brought into the range by the constraint. Nothing evens out what `uniform`
// and `clamp` change. As published, it starts once.
//
// Twin: shaders/array/solve/solve_eigenvalue.comp.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

inline constexpr double eigenvalue_ridge = 0.01;
inline constexpr std::uint32_t eigenvalue_steps = 100;  ///< at most, of repeated products
inline constexpr double eigenvalue_still = 1e-6;        ///< stops once no entry of the eigenvector moves by more

/// Keeps its storage from call to call.
struct EigenvalueScratch {
  std::vector<std::complex<double>> vector, next, system;
};

/// Fills `factors`, one per focus. `gains` are relative to the largest, 0..1. The eigenvector begins with the phases
/// of a sound that converges on the first transducer. At most most_solved_foci foci.
void eigenvalue_factors(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains,
                        std::span<std::complex<double>> factors, EigenvalueScratch& scratch);

}  // namespace palpa::array
