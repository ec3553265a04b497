// glTF extensions by name.
#pragma once

#include <string_view>

namespace palpa::geometry::gltf {

inline constexpr const char* instancing_extension = "EXT_mesh_gpu_instancing";
inline constexpr const char* visibility_extension = "KHR_node_visibility";

/// Whether palpa accepts a file that requires the extension: palpa supports it, or it cannot move a triangle
/// (materials, textures, lights, sound, animation). Compares the whole name, because the meaning of longer names is
/// unknown.
bool may_be_required(std::string_view extension);

}  // namespace palpa::geometry::gltf
