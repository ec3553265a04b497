// The Stanford bunny out of the file that the demo fetches, and two fingers that touch it (Fig. 3 of the paper).
#pragma once

#include <filesystem>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// Reads a script that assigns `positions=[[x,y,z],...]` and `cells=[[a,b,c],...]`, by its text alone: nothing is run.
/// Throws bad_input naming the file: no such arrays, rows that are not three numbers, corners out of range, more than
/// 16 MiB.
geometry::Mesh read_bunny(const std::filesystem::path& file);

/// The mesh scaled to `height` metres, standing on y = 0, the middle of its box on the y axis.
geometry::Mesh stand_up(geometry::Mesh mesh, double height);

/// A finger (tip at the origin, body along +y) that comes along `direction`, aimed at `target`, and stops with its tip
/// `penetration` metres behind the first triangle that this ray meets. Throws failure() where it meets none.
geometry::Mesh press_finger(const geometry::Mesh& finger, const geometry::Mesh& object, const Vec3& target,
                            const Vec3& direction, double penetration);

}  // namespace palpa::assets
