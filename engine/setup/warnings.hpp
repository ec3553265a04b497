// What can be done but can hardly be meant: each function tells it in one line of warning.
#pragma once

#include <span>
#include <string>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "geometry/solid.hpp"
#include "setup/options.hpp"

namespace palpa::setup {

/// A focus that lasts longer than this is felt as a jump from place to place, seconds.
inline constexpr double longest_usual_dwell_s = 50e-3;

/// Of --dwell, and of the solids that ask for one of their own.
void warn_of_dwell(const TouchOptions& options);
void warn_of_dwell(std::span<const geometry::Solid> solids);

/// A drive's frequency that is not what the layout's transducers are made for.
void warn_of_frequency(const array::Layout& layout, const array::Medium& medium);

/// Solids on which every focus would be out of the array's reach. All in the world.
void warn_of_reach(const array::Layout& layout, std::span<const geometry::Solid> solids);

/// What a summary says where a focus has more than array::linear_pressure_pa.
std::string linear_line();

}  // namespace palpa::setup
