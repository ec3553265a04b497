// How far each finger gets of the pressure it asks where an array cannot give all of them everything.
//
//   a   takes: the largest amplitude that a finger alone needs for all that it asks; above 1 it asks too much
//   s   its level, 0..1: one factor for all of its foci, in all slots
//   b   how much amplitude there is to share: 1, or more, as far as the fingers' sounds do not meet at one transducer
//
//   s = min(1, 1/a, u v),  v = 1 where a <= 1, else a^-16,  the largest u for which the sum of a s is at most b
//
// So fingers that each could have their pressure alone are lowered by one and the same factor. One that could not is
// lowered by itself first, and then yields: where it asks a third too much, it lowers another by a hundredth at most;
// farther out it gets what the others leave. Between, all is continuous: a finger that crosses the border of what can
// be reached makes nobody jump. Fingers that ask for no pressure come after all that do.
#pragma once

#include <span>

namespace palpa::array {

inline constexpr int level_yield = 16;

struct Demand {
  double takes = 0;
  bool asks = true;  ///< for a pressure; else it takes what it can get
};

/// Fills `levels`, one per demand. A finger that takes more than 1e12 can have nothing. `budget` is b.
void share_out(std::span<const Demand> demands, double budget, std::span<double> levels);

}  // namespace palpa::array
