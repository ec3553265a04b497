// Greedy phases: one transducer after the other takes that phase of a small set which serves the foci best, given all
// that have chosen before it.
//
//   minimise over phi: sum over foci m of (t_m L - |p_m + g_m e^{i phi}|)^2
//
//   p_m   what has been chosen so far gives at focus m
//   g_m   what this transducer gives there at full amplitude and phase 0
//   t_m   how loud the focus is to be: its relative gain over the root of the sum of their squares
//   L     how loud a single focus could be by now: the sum over all transducers so far, this one included, of the root
//         of the mean over the foci of |g_m|^2
//
// Transducers take turns all over the array, greedy_stride places on in layout order. Every amplitude is 1: the
// constraint does not matter. Of equally good phases the first is taken.
#pragma once

#include <cstdint>
#include <span>

#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr std::uint32_t greedy_phases = 16;  ///< 2 pi c / 16, c = 0 .. 15

/// The number coprime to `transducers` that is next to 0.618 of it, upwards; 1 for fewer than three.
std::uint32_t greedy_stride(std::uint32_t transducers);

/// Fills `phases`, one per transducer of `columns`: the number c of the phase that it takes. `gains` are relative,
/// 0..1, one per focus; at most most_solved_foci foci.
void greedy(const Columns& columns, std::span<const double> gains, std::span<std::uint8_t> phases);

}  // namespace palpa::array
