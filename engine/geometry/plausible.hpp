// Coordinates in the wrong unit: all files are in metres, and many programs write millimetres.
#pragma once

#include <string>

#include "base/math.hpp"

namespace palpa::geometry {

/// Why something in this box is too large or too small for a hand, a finger or a thing that hands touch, and in which
/// unit it would not be; the end of a line after its name. Empty if it is plausible, 1 mm to 5 m across.
std::string implausible_size(const Box& box);

}  // namespace palpa::geometry
