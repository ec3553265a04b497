// STL, the format that slicers for 3-D printers read.
#pragma once

#include <filesystem>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Binary STL in millimetres, the unit that slicers assume; triangles in the mesh's order. Throws failure() if the file
/// cannot be written completely.
void write_stl(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace palpa::geometry
