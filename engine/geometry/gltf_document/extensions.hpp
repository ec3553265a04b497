// Extensions of glTF by name.
#pragma once

#include <string_view>

namespace palpa::geometry::gltf {

inline constexpr const char* instancing_extension = "EXT_mesh_gpu_instancing";
inline constexpr const char* visibility_extension = "KHR_node_visibility";

/// Whether a file may require the extension: palpa reads it, or it cannot change where a triangle is (materials,
/// textures, lights, sound, animation). By its whole name: what a longer name means nobody knows.
bool may_be_required(std::string_view extension);

}  // namespace palpa::geometry::gltf
