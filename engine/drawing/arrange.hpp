// Scales pictures down and puts them side by side.
#pragma once

#include <cstdint>
#include <vector>

#include "drawing/png.hpp"

namespace palpa::drawing {

/// Half the width and height, rounded down: each pixel is the mean of four.
Pixels halved(const Pixels& picture);
/// Pictures in rows of `columns` (at least 1), in cells of the largest width; a row is as high as its highest picture.
/// The rest is white.
Pixels side_by_side(const std::vector<Pixels>& pictures, std::uint32_t columns);

}  // namespace palpa::drawing
