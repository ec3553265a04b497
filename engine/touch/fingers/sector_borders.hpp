// The directions of the borders between sectors of equal angle.
#pragma once

#include <cstddef>
#include <vector>

#include "touch/fingers/exact.hpp"

namespace palpa::touch {

/// The borders of N sectors for every N up to max_foci, one N after the other.
std::vector<Float2> sector_borders();

/// The index of the first border of a circle with `foci` sectors.
constexpr std::size_t first_border(std::size_t foci) {
  return foci * (foci - 1) / 2;
}

}  // namespace palpa::touch
