// What an array can be asked for but hardly is on purpose.
#pragma once

#include <string>

#include "array/layout.hpp"
#include "array/medium.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// Beyond it air has taken most of a 40 kHz sound, and an array of hands' size no longer focuses, metres.
inline constexpr double most_usual_distance_m = 2;

/// Why no focus in that box (a point is one) is worth much, as the end of a sentence about it: "lies behind the
/// array, ...". Empty where there is nothing to say: some of it is before a transducer and near enough to one.
std::string unusual_place(const Layout& layout, const Box& box);

/// Why that frequency does not go with the layout; empty within half of Layout::frequency_hz.
std::string unusual_frequency(const Layout& layout, double hz);

}  // namespace palpa::array
