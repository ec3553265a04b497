// Evens out the pressures of several foci: Levenberg and Marquardt's method for the few factors of the foci.
//
//   c     the factors, one per focus
//   p     R c, the pressures at the foci
//   t_j   target loudness of focus j; L the level, either given or the current one: sum |p| / sum t
//   m_j = 1 - |p_j| / (t_j L), the miss of focus j, 0 where t_j is 0
//   J_jq = e^{-i arg p_j} R_jq / (t_j L): |p_j| / (t_j L) grows by Re(sum over q of J_jq dc_q)
//
//   dc = J^H y,  (Re(J J^H) + lambda trace / foci) y = m
//
// is the smallest change of the factors that removes the misses. A step that increases the sum of squared misses is
// undone and retried with more damping, so the misses never grow.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

inline constexpr double even_damping = 0.03;        ///< initial lambda
inline constexpr double even_least_damping = 1e-4;  ///< below this, rounding dominates
inline constexpr double even_most_damping = 1e4;    ///< above this, no step helps
inline constexpr double even_less = 0.3;            ///< factor after a step that helped
inline constexpr double even_more = 4;              ///< factor after one that did not

struct EvenGoal {
  double level = 0;         ///< L; 0: the current level of the foci
  double most_miss = 0.01;  ///< stop once no focus misses by more
  std::uint32_t tries = 0;  ///< maximum number of steps, including undone ones
  bool by_focus = false;    ///< damp each focus by its own slope: for targets of very different sizes
};

/// Keeps its storage from call to call.
struct EvenScratch {
  std::vector<std::complex<double>> pressure, tried_pressure, tried, slopes;
  std::vector<double> normal, rest, miss;
};

/// The result.
struct Evened {
  double miss = 0;          ///< the largest remaining miss
  std::uint32_t tries = 0;  ///< steps made, including undone ones
};

/// Changes `factors`. `targets` are t_j, 0 and above.
Evened even_out(const FocusMatrix& matrix, std::span<const double> targets, const EvenGoal& goal,
                std::span<std::complex<double>> factors, EvenScratch& scratch);

/// L of the pressures: sum |p| / sum t, 0 if no focus has a target.
double level_of(std::span<const std::complex<double>> pressure, std::span<const double> targets);

/// Fills `miss` with the m_j for the level L; returns the sum of their squares.
double find_misses(std::span<const std::complex<double>> pressure, std::span<const double> targets, double level,
                   std::span<double> miss);
double largest_miss(std::span<const double> miss);

/// Solves (J J^T + damping) y = m in place: `normal` is J J^T, rows of `rest.size()`, and is overwritten; `rest` is m
/// and becomes y. `by_focus` as in EvenGoal.
void solve_damped(std::span<double> normal, double damping, bool by_focus, std::span<double> rest);

}  // namespace palpa::array
