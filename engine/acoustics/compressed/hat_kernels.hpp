// The inner loops of single rows and columns of the boundary elements' matrix (galerkin.hpp), for the processor in use.
#pragma once

#include <span>

#include "acoustics/boundary/galerkin_kernels.hpp"

namespace palpa::acoustics {

/// A sample of a vertex' hat function, with its weight w in the three-point rule of its patch: position in metres, the
/// hat times w times the patch's area (also as a vector along the normal), and w times the hat's surface curl and area.
struct HatSample {
  float at[3], size, area[3], curl[3];
};

/// One entry for each corner of sixteen patches, [corner][re, im][lane].
struct alignas(64) HatSums {
  float of[3][2][far_lanes];
};

/// The hat function as test function, with the hat functions of sixteen trial patches: a part of a row. All patches are
/// distant (three samples on each), and positions have the same origin.
void hat_row(std::span<const HatSample> test, const FarGroup& trials, float wave_number, HatSums& out);

/// The hat function as trial function, with the hat functions of sixteen test patches: a part of a column.
void hat_column(std::span<const HatSample> trial, const FarGroup& tests, float wave_number, HatSums& out);

}  // namespace palpa::acoustics
