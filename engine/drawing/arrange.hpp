// Pictures made smaller, and put beside each other.
#pragma once

#include <cstdint>
#include <vector>

#include "drawing/png.hpp"

namespace palpa::drawing {

/// Half as wide and high, rounded down: each pixel is the mean of four.
Pixels halved(const Pixels& picture);
/// Pictures in rows of `columns`, which is 1 at least, in places of the widest and the highest; the rest is white.
Pixels side_by_side(const std::vector<Pixels>& pictures, std::uint32_t columns);

}  // namespace palpa::drawing
