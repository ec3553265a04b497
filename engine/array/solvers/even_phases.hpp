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
// smallest change that does it. One pass over the transducers applies the previous y and sums p, and C for the next
// step. docs/notes/gs-pat.md#bounded-amplitudes has the reasons.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"
#include "array/solvers/even_out.hpp"

namespace palpa::array {

/// If a focus misses by more than this at first, `phases_raises` tries come first, in which each focus aims for
/// `phases_push` of L more than it misses. A try is kept if the weakest focus became louder.
inline constexpr double phases_uneven = 0.15;
inline constexpr double phases_push = 0.1;
inline constexpr std::uint32_t phases_raises = 6;
/// The part of its loudness that later tries must leave the weakest focus.
inline constexpr double phases_keep = 0.95;

/// Keeps its storage from call to call.
struct PhaseScratch {
  std::vector<std::complex<double>> tried;  ///< one per transducer
  std::vector<std::complex<double>> pressure, tried_pressure, pull;
  std::vector<std::complex<double>> alike, across, tried_across;  ///< A and C, [row * foci + column], column <= row
  std::vector<double> normal, rest, miss, tried_miss;
};

/// Changes the phases of `drive`, one per transducer, magnitudes 0 to 1. `targets` are t_j, at most most_solved_foci.
/// Ends once no focus misses by more than `most_miss`, or after `tries` tries.
Evened even_phases(const Columns& columns, std::span<const double> targets, double most_miss, std::uint32_t tries,
                   std::span<std::complex<double>> drive, PhaseScratch& scratch);

}  // namespace palpa::array
