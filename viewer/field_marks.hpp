// Sound in the picture: the field in a plane, the radiation pressure on the skin, and the bars that say what colours
// mean. Values come from whoever has them; nothing is computed here.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"
#include "viewer/picture.hpp"

namespace palpa::viewer {

/// Columns and rows of samples, at the centres of pixels.
struct SliceGrid {
  std::uint32_t columns = 0, rows = 0;
};
/// So many samples along the plane's longer side, near square ones.
SliceGrid slice_grid(const SliceState& slice, std::uint32_t along);
/// Where the samples lie: metres, world, row by row from the top.
std::vector<Vec3> slice_points(const SliceState& slice, const SliceGrid& grid);

/// Puts the plane into the picture in place of the one before, with its bar: the size of these complex pressures, peak
/// in Pa, one per sample. Beyond what linear acoustics can say (array::linear_pressure_pa) colours are by share of the
/// largest.
void show_slice(Picture& picture, const SliceState& slice, const SliceGrid& grid,
                std::span<const std::complex<double>> pressures);

/// Puts `body`, a closed mesh, into the picture as the skin's surface, in the colours of its radiation pressure, which
/// is by face in Pa, with a bar. What pulls the skin has the colour of nothing.
void show_heat(Picture& picture, std::string name, geometry::Mesh body, std::span<const double> pressure_pa);

/// The least number of one digit, or 1.5 times a power of ten, that is not below `most`; 1 for nothing.
double round_up(double most);

}  // namespace palpa::viewer
