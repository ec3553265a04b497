// STL: what programs that slice a model for a printer read.
#pragma once

#include <filesystem>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Binary STL in millimetres, which is what such programs take its numbers for; triangles in the mesh's order. Throws
/// failure() when the file cannot be written whole.
void write_stl(const std::filesystem::path& file, const Mesh& mesh);

}  // namespace palpa::geometry
