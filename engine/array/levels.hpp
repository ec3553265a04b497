// How much each finger gets of the pressure it requests if an array cannot satisfy all requests.
//
//   a   takes: the largest amplitude that a finger alone needs for its full request; above 1 it requests too much
//   s   its level, 0..1: one factor for all of its foci, in all slots
//   b   the amplitude to share: 1, or more as far as the fingers' sounds do not meet at one transducer
//
//   s = min(1, 1/a, u v),  v = 1 where a <= 1, else a^-16,  the largest u for which the sum of a s is at most b
//
// Fingers that each could have their pressure alone are thus lowered by the same factor. A finger that could not is
// first lowered by itself, and then yields to others: if it requests a third too much, it lowers another by a hundredth
// at most; far beyond that, it gets what the others leave. The transition is continuous: if a finger crosses the limit
// of what can be reached, no other finger changes suddenly. Fingers without a request come after all others.
#pragma once

#include <span>

namespace palpa::array {

inline constexpr int level_yield = 16;

struct Demand {
  double takes = 0;
  bool asks = true;  ///< for a pressure; otherwise it takes what it can get
};

/// Fills `levels`, one per demand. A finger that takes more than 1e12 gets nothing. `budget` is b.
void share_out(std::span<const Demand> demands, double budget, std::span<double> levels);

}  // namespace palpa::array
