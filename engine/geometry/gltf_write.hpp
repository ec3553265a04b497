// Triangle meshes as a binary glTF 2.0 file (.glb).
#pragma once

#include <filesystem>
#include <span>

#include "geometry/gltf.hpp"

namespace palpa::geometry {

/// Writes one scene with one node and one mesh of the same name for each of `meshes`, in their order. Positions become
/// 32-bit floats (with min and max), indices 16-bit where a mesh has fewer than 65536 vertices, else 32-bit. Vertices
/// and triangles keep their order, so load_gltf() gives the same meshes back; nothing but positions, names and
/// haptics is stored. The bytes depend on the arguments alone. Throws failure(), one line: a mesh without triangles, an
/// index out of range, a coordinate that a float cannot hold, more than 4 GiB, a file that cannot be written whole.
void write_glb(const std::filesystem::path& file, std::span<const SceneMesh> meshes);

}  // namespace palpa::geometry
