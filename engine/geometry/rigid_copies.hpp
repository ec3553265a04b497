// Finds the meshes of a scene that are rigid copies of one mesh. Results for the first of them hold for all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

/// For each mesh of the scene, the first mesh that it is a rigid copy of (the same mesh at the same scale, mirrored or
/// not), or itself. Only touchable meshes are copies; parts of solids are not. If a scene has little to save, each mesh
/// is prepared separately, so that the last bits of its results are those of its own position.
std::vector<std::uint32_t> find_rigid_copies(const Scene& scene);

/// Limit below which there is little to save: triangles of all copies together, plus `copy_overhead` per copy.
inline constexpr std::uint64_t worth_sharing = 50'000, copy_overhead = 1000;

/// For each vertex of `made`, which weld() and the repairs made from `original`, one of the original vertices that it
/// was made from. Empty if a vertex has none.
std::vector<std::uint32_t> vertices_of(const Mesh& original, const Mesh& made);

/// The plane, moved along with the object that it bounds. T is rigid except for a uniform scale.
Plane moved(const Plane& plane, const Transform& T);

}  // namespace palpa::geometry
