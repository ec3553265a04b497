// Triangle meshes as a binary glTF 2.0 file (.glb).
#pragma once

#include <filesystem>
#include <span>

#include "geometry/gltf/gltf.hpp"

namespace palpa::geometry {

/// Writes one scene with one node and one mesh of the same name for each of `meshes`, in their order. Positions become
/// 32-bit floats (with min and max), indices 16-bit where a mesh has fewer than 65536 vertices, else 32-bit. Vertices
/// and triangles keep their order, so load_gltf() gives the same meshes back; beside positions and names, haptics are
/// stored as the nodes' `extras`. Neighbours in the list that are parts of one solid stand under a node of the solid's
/// name, which has their haptics, each in a colour of its own. The bytes depend on the arguments alone. The file is
/// replaced as a whole: there is the old one or the new one. Throws failure(), one line: a mesh without triangles, an
/// index out of range, a coordinate that a float cannot hold, more than 4 GiB, a file that cannot be written whole.
void write_glb(const std::filesystem::path& file, std::span<const SceneMesh> meshes);

}  // namespace palpa::geometry
