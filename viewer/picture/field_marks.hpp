// Sound in the picture: the field in a plane, the radiation pressure on the skin, and the bars that say what colours
// mean. Values come from whoever has them; nothing is computed here.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "viewer/picture/picture.hpp"

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
/// is by vertex in Pa, with a bar. What pulls the skin has the colour of nothing.
void show_heat(Picture& picture, std::string name, geometry::Mesh body, std::span<const double> pressure_pa);

/// Takes the layer's bar away, and the plane with its own. Whether there was one.
bool hide_bar(Picture& picture, Layer layer);
bool hide_slice(Picture& picture);

/// Says so at the layer's bar, with how far the next is (", 40 %"; may be empty). Where there is no bar yet there is
/// one of that title and the note alone. Whether the picture has changed.
bool mark(Picture& picture, Layer layer, const std::string& title, Standing standing, const std::string& progress = {});
/// What stands beside the bar's title where the layer is not of what sounds now; else empty.
std::string note_of(const ColourBar& bar);
/// Whether the layer is not of what sounds now; then it is drawn dimmer.
bool is_stale(const Picture& picture, Layer layer);
inline constexpr float stale_opacity = 0.4f;

/// The least number of one digit, or 1.5 times a power of ten, that is not below `most`; 1 for nothing.
double round_up(double most);

}  // namespace palpa::viewer
