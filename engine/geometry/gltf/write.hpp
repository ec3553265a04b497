// Triangle meshes as a binary glTF 2.0 file (.glb).
#pragma once

#include <filesystem>
#include <span>

#include "geometry/gltf/gltf.hpp"

namespace palpa::geometry {

/// Writes one scene with one node and one mesh of the same name for each of `meshes`, in their order. Positions become
/// 32-bit floats (with min and max); indices have 16 bits if a mesh has fewer than 65536 vertices, else 32. Vertices
/// and triangles keep their order, so load_gltf() gives the same meshes back. Besides positions and names, haptics are
/// stored as the nodes' `extras`. Consecutive parts of one solid are children of a node with the solid's name, which
/// has their haptics; each part has its own colour. The bytes depend only on the arguments. The file is replaced
/// atomically: a reader finds the old or the new one. Throws failure(), one line: a mesh without triangles, an index
/// out of range, a coordinate that a float cannot hold, more than 4 GiB, a file that cannot be written completely.
void write_glb(const std::filesystem::path& file, std::span<const SceneMesh> meshes);

}  // namespace palpa::geometry
