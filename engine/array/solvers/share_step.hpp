// How much each focus counts in one step of a climb (climb.hpp): a quadratic problem as small as the number of foci.
//
//   minimise over z: z r + z K z / (2 stiffness) + spread z z / 2,  z >= 0,  sum z = 1
//
//   r_j   the loudness of focus j relative to its target
//   K_jk  the growth of r_j if focus k alone pulls the transducers
//   z_j   the share of focus j in the pull
//
// Without `spread`, after the step all foci with a share are at one level, r + K z / stiffness = L, and L is as high as
// a turn of this size allows. A focus that is louder than L anyway gets no share. With it, shares are more equal. The
// foci with a share are found in rounds: those with a negative share leave, those that would fall below the level
// return.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpa::array {

inline constexpr std::uint32_t share_rounds = 6;
inline constexpr double share_ridge = 1e-5;  ///< added to the diagonal of K, relative to its mean

/// Keeps its storage from call to call.
struct ShareScratch {
  std::vector<double> normal, ones, rest;
  std::vector<std::uint8_t> takes, returns;  ///< foci that take part in a round, and in the next one
};

/// Fills `shares`; returns L. `growth` is K, rows of `loud.size()`. Foci with `counts` 0 get no share.
double find_shares(std::span<const double> growth, std::span<const double> loud, std::span<const std::uint8_t> counts,
                   double stiffness, double spread, std::span<double> shares, ShareScratch& scratch);

/// Fills `shares`, of any sign and sum, so that every focus changes by `change`: K z = change.
void find_changes(std::span<const double> growth, std::span<const double> change, std::span<const std::uint8_t> counts,
                  std::span<double> shares, ShareScratch& scratch);

}  // namespace palpa::array
