// Raises the weakest of several foci when amplitudes are fixed and only phases may change.
//
//   x_n      the drive of transducer n;  p = G x;  u_j = p_j / |p_j|;  r_j = |p_j| / t_j
//   z_j      the share of focus j, sum z = 1 (share_step())
//   h_n      sum over j of z_j / t_j u_j* G_jn x_n: what transducer n gives to the foci, each by its share
//   D_n      |h_n| + climb_soft times the mean of |h_n|: how stiff transducer n is
//   J_jn     -Im(u_j* G_jn x_n) / t_j, the derivative of r_j by the phase of x_n
//   K_jk     sum over n of J_jn J_kn / D_n, over a part of the transducers
//
// One step turns each transducer by -Im(h_n) / (stiffness D_n), with the shares that raise the common level most. A
// step that does not raise its goal is undone and tried again, stiffer. The goal is a soft minimum in two stages, with
// m the mean of r at the beginning, and then the weakest focus:
//
//   -m / B log sum over j of e^(-B r_j / m),  B = climb_sharpness
//
// At last, louder foci are lowered while the weakest keeps ClimbEffort::keep. docs/notes/gs-pat.md has the reasons.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"
#include "array/solvers/climb_lanes.hpp"

namespace palpa::array {

// How much each focus counts in one step of a climb: a quadratic problem as small as the number of foci.
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

inline constexpr double climb_sharpness[] = {20, 80};
inline constexpr double climb_soft = 0.2;
inline constexpr double climb_least_stiffness = 0.5;
inline constexpr double climb_most_stiffness = 60;
inline constexpr double climb_softer = 0.5;   ///< factor of the stiffness after a step that helped
inline constexpr double climb_stiffer = 3;    ///< factor after one that did not
inline constexpr double climb_most_turn = 1;  ///< rad, of a transducer in one step
inline constexpr double climb_even = 0.003;   ///< stops lowering once no focus is louder by more
/// Stops lowering if steps of this part of the differences do not help.
inline constexpr double climb_least_aim = 0.05;

struct ClimbEffort {
  std::uint32_t soft_steps = 0;   ///< maximum number of steps of each soft stage, including those not kept
  std::uint32_t steps = 0;        ///< maximum number of steps up after them, including those not kept
  std::uint32_t lowerings = 0;    ///< maximum number of steps that lower, including those not kept
  std::uint32_t transducers = 0;  ///< K comes from about this many of them
  double enough = 1e-3;           ///< ends a stage once a step raises its goal by a smaller part
  double keep = 0.996;            ///< the part of its loudness that the weakest keeps while others are lowered
};

/// Keeps its storage from call to call.
struct ClimbScratch {
  LaneDrives tried;
  std::vector<std::complex<double>> pressure, tried_pressure, pull, stiff_pull, turn;
  std::vector<double> growth, loud, tried_loud, tried_shares, change;
  std::vector<std::uint8_t> counts;
  ShareScratch step;
};

/// Reserves memory.
void reserve(ClimbScratch& scratch, std::size_t transducers, std::size_t foci);

/// Changes the phases of `drive`, one per transducer, magnitudes 0 to 1. `targets` are t_j; foci whose target is 0 are
/// ignored. `shares` are z_j, for the first stiffness, and afterwards the last ones. Returns the loudness of the
/// weakest focus relative to its target, 0 if no focus has one.
double climb(const LaneColumns& columns, std::span<const double> targets, const ClimbEffort& effort,
             std::span<double> shares, LaneDrives& drive, ClimbScratch& scratch);

}  // namespace palpa::array
