// The phase that all transducers of a drive have in common is free. It decides how a board with few phase steps rounds
// each of them, and so what the rounding leaves at nulls.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/split_rows.hpp"

namespace palpa::array {

/// The phase steps of SonicSurface, OpenMPD and AUTD3, for which the common phase is chosen, and how loud a null may
/// then be relative to the weakest focus: -38, -48 and -53 dB.
struct Rounding {
  std::uint32_t steps;
  double depth;
};
inline constexpr Rounding roundings[] = {{32, 0.0126}, {128, 0.004}, {256, 0.00224}};
inline constexpr std::uint32_t common_phases = 16;  ///< tried, within a step of the coarsest

/// Keeps its storage from call to call.
struct RoundingScratch {
  std::vector<double> size, turns;
};

/// Turns `drive` as a whole so that, rounded to each of these steps, the loudest null stays as far as possible below
/// what it may have. Changes nothing if it stays below anyway. `nulls`: the sound of the transducers at each; at most
/// 64.
void choose_common_phase(const SplitRows& nulls, double weakest_focus, std::span<std::complex<double>> drive,
                         RoundingScratch& scratch);

}  // namespace palpa::array
