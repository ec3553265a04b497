// Solids whose surface consists of convex parts: read from a file that palpa decompose wrote, or made from a mesh.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/decompose.hpp"
#include "geometry/solid.hpp"

namespace palpa::geometry {

/// The scene's meshes that are marked as parts, grouped by solid. Each solid comes with the index of its first part
/// among the scene's meshes. A solid's `mesh` holds its parts' hulls side by side, for drawing. Throws bad_input naming
/// file and mesh: a part that is open, concave or flat; more than most_parts of one solid.
std::vector<std::pair<std::size_t, Solid>> solids_of_parts(const Scene& scene);

/// Replaces a solid's surface by convex parts of its mesh, with a warning if they fill a cavity. Returns false if
/// cancelled; the solid is then unchanged. Throws as decompose() does, naming the solid. Results are cached
/// (base/files/cache_file.hpp).
bool use_parts(Solid& solid, const DecomposeOptions& options, const Progress& progress = {});

}  // namespace palpa::geometry
