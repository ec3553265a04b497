// The phase that all transducers of a drive have in common is free. It decides how a board with few phase steps rounds
// each of them, and so what the rounding leaves at nulls.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/split_rows.hpp"

namespace palpa::array {

inline constexpr std::uint32_t common_phases = 16;  ///< tried, within a step of the board with the fewest

/// Keeps its storage from call to call.
struct RoundingScratch {
  std::vector<double> size, turns;
};

/// Turns `drive` as a whole so that, rounded to the phase steps of each type of board, the loudest null stays as far as
/// possible below what it may have with that type (BoardType::null_depth). Changes nothing if it stays below anyway.
/// `nulls`: the sound of the transducers at each; at most 64.
void choose_common_phase(const SplitRows& nulls, double weakest_focus, std::span<std::complex<double>> drive,
                         RoundingScratch& scratch);

}  // namespace palpa::array
