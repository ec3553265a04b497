// A body in the sound, from its file.
#pragma once

#include <string>

#include "acoustics/air.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::setup {

/// The triangles of a file (geometry/files/load_triangles.hpp) as a body that sound can be scattered by: closed, facing
/// outwards, fine enough for the tone unless `force`, and not too large for the memory; warns of needles
/// (acoustics/bodies/body_mesh.hpp). Throws bad_input and failure.
geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force);

}  // namespace palpa::setup
