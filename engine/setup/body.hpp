// A body in the sound, from its file.
#pragma once

#include <string>

#include "acoustics/air.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::setup {

/// A mesh as a body that sound can be scattered by: welded, closed, facing outwards, fine enough for the tone unless
/// `force`, and not too large for the memory; warns of needles (acoustics/bodies/body_mesh.hpp). Messages call it
/// `name`. Throws bad_input and failure.
geometry::Mesh body_of(const std::string& name, const geometry::Mesh& mesh, const acoustics::Air& air, bool force);

/// The same of the triangles of a file (geometry/files/load_triangles.hpp).
geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force);

}  // namespace palpa::setup
