// Sound in the picture: the field in a plane, the radiation pressure on the skin, and the bars that say what colours
// mean. The caller provides the values; nothing is computed here.
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
/// A grid with `along` nearly square samples along the plane's longer side.
SliceGrid slice_grid(const SliceState& slice, std::uint32_t along);
/// Where the samples lie: metres, world, row by row from the top.
std::vector<Vec3> slice_points(const SliceState& slice, const SliceGrid& grid);

/// Puts the plane into the picture in place of the one before, with its bar. Colours show the magnitude of `pressures`,
/// which are complex, peak in Pa, one per sample. Beyond the range of linear acoustics (array::linear_pressure_pa),
/// they show the share of the largest.
void show_slice(Picture& picture, const SliceState& slice, const SliceGrid& grid,
                std::span<const std::complex<double>> pressures);

/// Puts `body`, a closed mesh, into the picture as the skin's surface, with a bar. Its colours show the values, given
/// per vertex. Values below zero, such as a pressure that pulls the skin, have the colour of zero; NaN is grey. `title`
/// is the bar's.
void show_heat(Picture& picture, std::string name, geometry::Mesh body, std::span<const double> values,
               const std::string& title);

/// Removes the layer's bar, or the plane with its bar. Returns whether there was one.
bool hide_bar(Picture& picture, Layer layer);
bool hide_slice(Picture& picture);

/// Shows `standing` at the layer's bar, with the progress of the next result (", 40 %"; may be empty). If there is no
/// bar yet, it gets one with only that title and the note. Returns whether the picture has changed.
bool mark(Picture& picture, Layer layer, const std::string& title, Standing standing, const std::string& progress = {});
/// The note beside the bar's title if the layer does not show what sounds now; else empty.
std::string note_of(const ColourBar& bar);
/// Whether the layer does not show what sounds now. It is drawn dimmer then.
bool is_stale(const Picture& picture, Layer layer);
inline constexpr float stale_opacity = 0.4f;

/// The smallest number with one significant digit, or 1.5 times a power of ten, that is not below `most`; 1 if `most`
/// is 0.
double round_up(double most);

}  // namespace palpa::viewer
