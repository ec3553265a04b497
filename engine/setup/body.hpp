// A body in the sound, from its file.
#pragma once

#include <string>

#include "acoustics/air.hpp"
#include "geometry/mesh.hpp"

namespace palpa::setup {

/// The triangles of a PLY or a glTF file (.gltf, .glb: all meshes of its scene), polygons cut into fans, in file order.
/// Throws bad_input as their readers do.
geometry::Mesh load_triangles(const std::string& file);

/// The same as a body that sound can be scattered by: closed, facing outwards, fine enough for the tone unless `force`,
/// and not too large for the memory (acoustics/body_mesh.hpp). Throws bad_input and failure.
geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force);

}  // namespace palpa::setup
