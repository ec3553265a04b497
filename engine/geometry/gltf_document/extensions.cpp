#include "geometry/gltf_document/extensions.hpp"

#include <algorithm>
#include <array>

namespace palpa::geometry::gltf {
namespace {

// These extensions move triangles, or determine which exist; palpa reads them.
constexpr std::array<std::string_view, 6> read{"KHR_mesh_quantization",   "KHR_draco_mesh_compression",
                                               "EXT_meshopt_compression", "KHR_meshopt_compression",
                                               instancing_extension,      visibility_extension};

constexpr std::array<std::string_view, 40> harmless{"KHR_materials_anisotropy",
                                                    "KHR_materials_clearcoat",
                                                    "KHR_materials_cmn",
                                                    "KHR_materials_common",
                                                    "KHR_materials_diffuse_transmission",
                                                    "KHR_materials_dispersion",
                                                    "KHR_materials_emissive_strength",
                                                    "KHR_materials_ior",
                                                    "KHR_materials_iridescence",
                                                    "KHR_materials_pbrSpecularGlossiness",
                                                    "KHR_materials_sheen",
                                                    "KHR_materials_specular",
                                                    "KHR_materials_subsurface",
                                                    "KHR_materials_transmission",
                                                    "KHR_materials_unlit",
                                                    "KHR_materials_variants",
                                                    "KHR_materials_volume",
                                                    "KHR_materials_volume_scatter",
                                                    "EXT_materials_bump",
                                                    "KHR_texture_basisu",
                                                    "KHR_texture_procedurals",
                                                    "KHR_texture_transform",
                                                    "EXT_texture_astc",
                                                    "EXT_texture_avif",
                                                    "EXT_texture_procedurals",
                                                    "EXT_texture_webp",
                                                    "MSFT_texture_dds",
                                                    "KHR_lights_common",
                                                    "KHR_lights_punctual",
                                                    "EXT_lights_ies",
                                                    "EXT_lights_image_based",
                                                    "KHR_xmp",
                                                    "KHR_xmp_json_ld",
                                                    "KHR_animation_pointer",
                                                    "KHR_audio",
                                                    "KHR_audio_emitter",
                                                    "KHR_node_selectability",
                                                    "MSFT_packing_normalRoughnessMetallic",
                                                    "MSFT_packing_occlusionRoughnessMetallic",
                                                    "FB_ngon_encoding"};

}  // namespace

bool may_be_required(std::string_view extension) {
  const auto is_it = [&](std::string_view name) { return name == extension; };
  return std::any_of(read.begin(), read.end(), is_it) || std::any_of(harmless.begin(), harmless.end(), is_it);
}

}  // namespace palpa::geometry::gltf
