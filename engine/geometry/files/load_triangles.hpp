// Triangles from a file of any supported format.
#pragma once

#include <string>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// The triangles of a glTF file (.gltf, .glb, in any case: all meshes of its scene) or of a PLY file (any other name),
/// polygons cut into fans, in file order; empty if the file has none. Throws bad_input as the readers do.
Mesh load_triangles(const std::string& file);

}  // namespace palpa::geometry
