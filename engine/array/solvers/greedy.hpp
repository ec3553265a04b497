// Greedy phases: each transducer in turn takes the phase from a small set that serves the foci best, given all
// transducers that have chosen before.
//
//   minimise over phi: sum over foci m of (t_m L - |p_m + g_m e^{i phi}|)^2
//
//   p_m   the pressure at focus m from the transducers that have chosen so far
//   g_m   the pressure of this transducer there at full amplitude and phase 0
//   t_m   target loudness of the focus: its relative gain over the root of the sum of their squares
//   L     how loud a single focus could be so far: the sum over all transducers up to and including this one of the
//          root of the mean over the foci of |g_m|^2
//
// The sequence of transducers covers the whole array, in steps of greedy_stride in layout order. Every amplitude is 1,
// so the constraint has no effect. If several phases are equally good, the first is taken.
#pragma once

#include <cstdint>
#include <span>

#include "array/field/transfer.hpp"

namespace palpa::array {

inline constexpr std::uint32_t greedy_phases = 16;  ///< 2 pi c / 16, c = 0 .. 15

/// The smallest number from 0.618 of `transducers` upwards that is coprime to it; 1 for fewer than three.
std::uint32_t greedy_stride(std::uint32_t transducers);

/// Fills `phases`, one per transducer of `columns`: the number c of its phase. `gains` are relative, 0..1, one per
/// focus; at most most_solved_foci foci.
void greedy(const Columns& columns, std::span<const double> gains, std::span<std::uint8_t> phases);

}  // namespace palpa::array
