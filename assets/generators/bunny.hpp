// The Stanford bunny from the file that the demo fetches, and two fingers that touch it (Fig. 3 of the paper).
#pragma once

#include <filesystem>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// Reads a script that assigns `positions=[[x,y,z],...]` and `cells=[[a,b,c],...]`. Only its text is parsed, nothing is
/// run. Throws bad_input with the file's name if there are no such arrays, rows are not three numbers, corners are out
/// of range, or the file is larger than 16 MiB.
geometry::Mesh read_bunny(const std::filesystem::path& file);

/// The mesh scaled to `height` metres. It stands on y = 0, with the middle of its box on the y axis.
geometry::Mesh stand_up(geometry::Mesh mesh, double height);

/// A finger (tip at the origin, body along +y) that moves along `direction` towards `target` and stops with its tip
/// `penetration` metres behind the first triangle that this ray meets. Throws failure() if it meets none.
geometry::Mesh press_finger(const geometry::Mesh& finger, const geometry::Mesh& object, const Vec3& target,
                            const Vec3& direction, double penetration);

}  // namespace palpa::assets
