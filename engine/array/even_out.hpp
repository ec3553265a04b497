// Evening out what several foci hear: Levenberg and Marquardt's method for the few numbers that foci are.
//
//   c     the factors, one per focus
//   p     R c, what the foci hear
//   t_j   how loud focus j is to be; L the level, either given or what they are now: sum |p| / sum t
//   m_j = 1 - |p_j| / (t_j L), the miss of focus j, 0 where t_j is 0
//   J_jq = e^{-i arg p_j} R_jq / (t_j L): |p_j| / (t_j L) grows by Re(sum over q of J_jq dc_q)
//
//   dc = J^H y,  (Re(J J^H) + lambda trace / foci) y = m
//
// is the least change of the factors that does it. A step that makes the sum of squared misses larger is taken back
// and tried with more damping: the misses never grow.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/transfer.hpp"

namespace palpa::array {

inline constexpr double even_damping = 0.03;        ///< lambda at first
inline constexpr double even_least_damping = 1e-4;  ///< rounding decides below
inline constexpr double even_most_damping = 1e4;    ///< no step helps any more
inline constexpr double even_less = 0.3;            ///< by this after a step that helped
inline constexpr double even_more = 4;              ///< by this after one that did not

struct EvenGoal {
  double level = 0;         ///< L; 0: what the foci are now
  double most_miss = 0.01;  ///< ends where no focus misses by more
  std::uint32_t tries = 0;  ///< at most so many steps, those taken back included
  bool by_focus = false;    ///< each focus is damped by its own slope: for targets of very different sizes
};

/// Keeps its storage from call to call.
struct EvenScratch {
  std::vector<std::complex<double>> pressure, tried_pressure, tried, slopes;
  std::vector<double> normal, rest, miss;
};

/// How far it got.
struct Evened {
  double miss = 0;          ///< the largest that is left
  std::uint32_t tries = 0;  ///< steps made, those taken back included
};

/// Moves `factors`. `targets` are t_j, 0 and above.
Evened even_out(const FocusMatrix& matrix, std::span<const double> targets, const EvenGoal& goal,
                std::span<std::complex<double>> factors, EvenScratch& scratch);

/// L of what is heard: sum |p| / sum t, 0 where no focus is to be heard.
double level_of(std::span<const std::complex<double>> pressure, std::span<const double> targets);

/// Fills `miss` with the m_j for the level L; returns the sum of their squares.
double find_misses(std::span<const std::complex<double>> pressure, std::span<const double> targets, double level,
                   std::span<double> miss);
double largest_miss(std::span<const double> miss);

/// Solves (J J^T + damping) y = m in place: `normal` is J J^T, rows of `rest.size()`, and is used up; `rest` is m and
/// becomes y. `by_focus` as in EvenGoal.
void solve_damped(std::span<double> normal, double damping, bool by_focus, std::span<double> rest);

}  // namespace palpa::array
