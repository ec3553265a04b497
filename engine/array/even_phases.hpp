// Evening out what several foci hear where amplitudes are given and transducers can but turn: Levenberg and Marquardt's
// method of even_out.hpp, not in the few factors but in the phases of all transducers.
//
//   x_n     what transducer n does;  p = G x
//   u_j     p_j / |p_j|
//   J_jn = -Im(u_j* G_jn x_n)   how |p_j| follows the phase of x_n
//   J J^T_jk = Re(u_j* u_k A_jk - u_j* u_k* C_jk) / 2,  A_jk = sum over n of G_jn G_kn* |x_n|^2,
//   C_jk = sum over n of G_jn G_kn x_n^2
//
// each row over t_j L, the misses m_j and the damping being those of even_out.hpp. The phases turn by J^T y, the least
// that does it, y from as small a system as the foci are. One walk over the transducers turns them by the y before and
// sums what the foci hear then, p, and C for the next step.
//
// A transducer whose sum was almost 0 is no worse than any other here: it may turn as far as it likes, while the
// factors can but turn it with all that are near it.
//
// Levelling out costs those that are loud: where at first a focus misses by more than phases_uneven, phases_raises
// tries come first in which each focus is asked for phases_push of L more than it misses, m_j + phases_push; they stay
// where the weakest focus, by its t_j, has become louder. Later ones stay where the misses are smaller in sum of
// squares and the weakest has kept phases_keep of its loudness: far steps can even foci out in a sound half as loud.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/even_out.hpp"
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

/// Turns `does`, one per transducer, magnitudes 0 to 1. `targets` are t_j, at most most_solved_foci. Ends where no
/// focus misses by more than `most_miss`, or after so many tries.
Evened even_phases(const Columns& columns, std::span<const double> targets, double most_miss, std::uint32_t tries,
                   std::span<std::complex<double>> does, PhaseScratch& scratch);

}  // namespace palpa::array
