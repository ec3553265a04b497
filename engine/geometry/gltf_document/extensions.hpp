// glTF extensions by name.
#pragma once

#include <string>
#include <string_view>

namespace palpa::geometry::gltf {

inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";
inline constexpr const char* instancing_extension = "EXT_mesh_gpu_instancing";
inline constexpr const char* visibility_extension = "KHR_node_visibility";

/// Names between spaces. Those of the first two lines move triangles, or determine which exist; palpa reads them.
inline constexpr std::string_view accepted =
    " KHR_mesh_quantization KHR_draco_mesh_compression EXT_meshopt_compression KHR_meshopt_compression "
    "EXT_mesh_gpu_instancing KHR_node_visibility "
    "KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_cmn KHR_materials_common "
    "KHR_materials_diffuse_transmission KHR_materials_dispersion KHR_materials_emissive_strength "
    "KHR_materials_ior KHR_materials_iridescence KHR_materials_pbrSpecularGlossiness KHR_materials_sheen "
    "KHR_materials_specular KHR_materials_subsurface KHR_materials_transmission KHR_materials_unlit "
    "KHR_materials_variants KHR_materials_volume KHR_materials_volume_scatter EXT_materials_bump "
    "KHR_texture_basisu KHR_texture_procedurals KHR_texture_transform EXT_texture_astc EXT_texture_avif "
    "EXT_texture_procedurals EXT_texture_webp MSFT_texture_dds KHR_lights_common KHR_lights_punctual "
    "EXT_lights_ies EXT_lights_image_based KHR_xmp KHR_xmp_json_ld KHR_animation_pointer KHR_audio "
    "KHR_audio_emitter KHR_node_selectability MSFT_packing_normalRoughnessMetallic "
    "MSFT_packing_occlusionRoughnessMetallic FB_ngon_encoding ";

/// Whether palpa accepts a file that requires the extension: palpa supports it, or it cannot move a triangle
/// (materials, textures, lights, sound, animation). Compares the whole name, because the meaning of longer names is
/// unknown.
inline bool may_be_required(std::string_view extension) {
  return extension.find(' ') == std::string_view::npos &&
         accepted.find(' ' + std::string(extension) + ' ') != std::string_view::npos;
}

}  // namespace palpa::geometry::gltf
