// Solids whose surface is that of convex parts: read from a file that palpa decompose wrote, or made from a mesh.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/decompose.hpp"
#include "geometry/solid.hpp"

namespace palpa::geometry {

/// The scene's meshes that are marked as parts, those of one solid together, each solid with the place of its first
/// part among the scene's meshes. A solid's `mesh` is its parts' hulls side by side, for drawing. Throws bad_input
/// naming file and mesh: a part that is open, concave or flat; more than most_parts of one solid.
std::vector<std::pair<std::size_t, Solid>> solids_of_parts(const Scene& scene);

/// Makes a solid's surface that of convex parts of its mesh. False when cancelled: the solid is as it was. Throws as
/// decompose() does, naming the solid. What was once made is cached (base/cache_file.hpp).
bool use_parts(Solid& solid, const DecomposeOptions& options, const Progress& progress = {});

}  // namespace palpa::geometry
