// Values at points or on cells as a VTU file for ParaView: VTK's XML of an unstructured grid, whose arrays are base64
// of little-endian numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"

namespace palpa::geometry {

/// Cells of one shape. `corners` holds the point indices of each cell, in order around it.
struct VtuCells {
  enum class Shape : std::uint8_t { vertex = 1, line = 3, triangle = 5, quad = 9 };  ///< VTK's numbers
  Shape shape = Shape::vertex;
  std::vector<std::uint32_t> corners;
};

/// One value per point or per cell, in index order.
struct VtuValues {
  std::string name;  ///< letters, digits, spaces and (), such as "amplitude (Pa)"
  std::span<const float> values;
};

/// Throws failure() naming the file if it cannot be written completely. NaN is written unchanged.
void write_vtu(const std::filesystem::path& file, std::span<const Vec3> points, const VtuCells& cells,
               std::span<const VtuValues> of_points, std::span<const VtuValues> of_cells = {});

}  // namespace palpa::geometry
