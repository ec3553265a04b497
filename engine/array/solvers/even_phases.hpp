// Evens out the pressures of several foci when amplitudes are fixed and only phases may change: the Levenberg-Marquardt
// method of even_out.hpp, applied to the phases of all transducers instead of a few factors.
//
//   x_n     the drive of transducer n;  p = G x
//   u_j     p_j / |p_j|
//   J_jn = -Im(u_j* G_jn x_n)   the derivative of |p_j| by the phase of x_n
//   J J^T_jk = Re(u_j* u_k A_jk - u_j* u_k* C_jk) / 2,  A_jk = sum over n of G_jn G_kn* |x_n|^2,
//   C_jk = sum over n of G_jn G_kn x_n^2
//
// each row divided by t_j L. The misses m_j and the damping are those of even_out.hpp. The phases change by J^T y, the
// smallest change that does it; y comes from a system whose size is the number of foci. One pass over the transducers
// applies the previous y and sums the new pressures p at the foci, and C for the next step.
//
// A transducer whose sum was almost 0 is no problem here: its phase may change by any amount, whereas the factors can
// only change it together with all transducers near it.
//
// Evening out makes loud foci quieter. If a focus initially misses by more than phases_uneven, phases_raises tries come
// first. In these, each focus aims for phases_push of L more than it misses, m_j + phases_push, and a try is kept if
// the weakest focus, relative to its t_j, became louder. Later tries are kept if the sum of squared misses decreases
// and the weakest focus has kept phases_keep of its loudness, because large steps can even foci out at half the
// loudness.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/solvers/even_out.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double phases_uneven = 0.15;
inline constexpr double phases_push = 0.1;
inline constexpr std::uint32_t phases_raises = 6;
inline constexpr double phases_keep = 0.95;

/// Keeps its storage from call to call.
struct PhaseScratch {
  std::vector<std::complex<double>> tried;  ///< one per transducer
  std::vector<std::complex<double>> pressure, tried_pressure, pull;
  std::vector<std::complex<double>> alike, across, tried_across;  ///< A and C, [row * foci + column], column <= row
  std::vector<double> normal, rest, miss, tried_miss;
};

/// Changes the phases of `does`, one per transducer, magnitudes 0 to 1. `targets` are t_j, at most most_solved_foci.
/// Ends once no focus misses by more than `most_miss`, or after `tries` tries.
Evened even_phases(const Columns& columns, std::span<const double> targets, double most_miss, std::uint32_t tries,
                   std::span<std::complex<double>> does, PhaseScratch& scratch);

}  // namespace palpa::array
