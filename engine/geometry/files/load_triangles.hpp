// Triangles from a file, whichever of the formats it has.
#pragma once

#include <string>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// The triangles of a glTF file (.gltf, .glb, in any case: all meshes of its scene) or a PLY (whatever else it is
/// called), polygons cut into fans, in file order; none where it has none. Throws bad_input as their readers do.
Mesh load_triangles(const std::string& file);

}  // namespace palpa::geometry
