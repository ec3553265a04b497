// Which of a scene's meshes are one mesh, moved: what is found about the first of them holds for all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

/// For each mesh of the scene the first one that it is a rigid copy of (the same mesh at the same scale, mirrored or
/// not), or itself. Only touchable ones are copies of one another; parts of solids are not. A scene with little to
/// spare is left as it is, each mesh prepared for itself, so that the last bits of its answers are those of its own
/// place.
std::vector<std::uint32_t> find_rigid_copies(const Scene& scene);

/// How much is little: triangles of all copies together, each copy counted as `copy_overhead` more.
inline constexpr std::uint64_t worth_sharing = 50'000, copy_overhead = 1000;

/// For each vertex of `made`, what weld() and what mends made of `original`, one of the vertices that it was made of.
/// Empty where one is of none.
std::vector<std::uint32_t> vertices_of(const Mesh& original, const Mesh& made);

/// Takes a plane along with what it bounds; T is rigid but for the scale that it has in common with where the plane is
/// now.
Plane moved(const Plane& plane, const Transform& T);

}  // namespace palpa::geometry
