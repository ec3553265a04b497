// A place where the sound of a drive is to be zero.
#pragma once

#include <cstddef>

#include "base/math.hpp"

namespace palpa::array {

struct Null {
  Vec3 position;        ///< metres, in the layout's frame as posed
  double radius_m = 0;  ///< 0: the place alone
};

inline constexpr std::size_t most_nulls = 64;
inline constexpr double most_null_radius_m = 5e-3;

}  // namespace palpa::array
