// Loads a rigid body for scattering from its file, and prints how its equations were solved.
#pragma once

#include <string>

#include "acoustics/air.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::setup {

/// Makes a mesh a body that scatters sound: welded, closed, facing outwards, fine enough for the tone unless `force`,
/// and not too large for the memory. Warns of needles and of bends (acoustics/bodies/body_mesh.hpp). Messages call it
/// `name`. Throws bad_input and failure.
geometry::Mesh body_of(const std::string& name, const geometry::Mesh& mesh, const acoustics::Air& air, bool force);

/// The same for the triangles of a file (geometry/files/load_triangles.hpp).
geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force);

/// "iterations", "residual" of a body whose equations are solved by iterations.
const JsonRows<acoustics::RigidBody::Effort>& solution_rows();
/// Adds them as "solution"; nothing for other bodies.
void add_solution(JsonWriter& json, const acoustics::RigidBody::Effort& effort);

}  // namespace palpa::setup
