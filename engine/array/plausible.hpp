// Detects requests to an array that are probably mistakes.
#pragma once

#include <string>

#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// In metres. Beyond this, air has absorbed most of a 40 kHz sound, and an array of the size of hands no longer
/// focuses.
inline constexpr double most_plausible_distance_m = 2;

/// Why no focus in the box (a point is also a box) is useful, as the end of a sentence about it: "lies behind the
/// array, ...". Empty if there is no reason: some of the box is in front of a transducer and near enough to one.
std::string implausible_place(const Layout& layout, const Box& box);

/// Why the frequency does not suit the layout: boards emit another one, or it differs by more than half from
/// Layout::frequency_hz. Empty if it suits.
std::string implausible_frequency(const Layout& layout, double hz);

}  // namespace palpa::array
