// Directions of equally wide sectors' borders, for the pass and its twin.
#pragma once

#include <cstddef>
#include <vector>

#include "shaders/touch/foci/foci.h"

namespace palpa::touch {

/// The borders of N sectors for every N up to max_foci, one N after the other.
std::vector<shader::Border> sector_borders();

/// Where those of `foci` sectors begin.
constexpr std::size_t first_border(std::size_t foci) {
  return foci * (foci - 1) / 2;
}

}  // namespace palpa::touch
