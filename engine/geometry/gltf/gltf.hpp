// glTF 2.0 models (.gltf with files or data URIs, .glb) as world-space triangle meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/haptics.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/part_of.hpp"

namespace palpa::geometry {

/// Identifies meshes of a scene that differ only in their transform.
struct CopyOf {
  std::uint32_t mesh = 0;       ///< equal for all nodes that show one mesh in the same pose of its bones and morph
                                ///< targets
  Transform T_world_mesh{1.0};  ///< the transform of that mesh's vertices to the world; may scale and mirror
};

/// One node's mesh: all its triangle primitives together, in the scene's coordinates (= world), not yet welded.
struct SceneMesh {
  std::string name;  ///< the node's name, else its mesh's, else "node N"; an instance adds its index: "name[i]"
  Mesh mesh;
  Haptics haptics{};             ///< of the node's extras; missing values come from the nearest ancestor that has them
  std::optional<PartOf> part{};  ///< of the node's extras: if set, this is not a solid but a part of one
  std::optional<CopyOf> copy{};  ///< nullopt if the node has its own morph weights
};

struct Scene {
  std::string file;
  std::vector<SceneMesh> meshes{};  ///< depth-first in the scene's node order
  std::string hidden{};             ///< which meshes a scale of zero hides, as a clause for messages; empty: none
};

/// Reads `scene_index`, or the file's default scene, or scene 0; for a file without scenes, all root nodes.
///
/// Supported: triangle lists, strips and fans, with indices of 8, 16 or 32 bits or none; sparse and interleaved
/// accessors; quantized positions (KHR_mesh_quantization); draco streams (KHR_draco_mesh_compression; an uncompressed
/// copy is preferred if there is one) and packed buffer views (EXT_meshopt_compression; a fallback is never read); node
/// hierarchies, TRS and matrices, negative scale (triangles are flipped so that they still face outwards); meshes that
/// several nodes show, and nodes that show theirs many times (EXT_mesh_gpu_instancing, which skinned nodes ignore);
/// skins in the pose of the file's bones, which is the bind pose if the file's nodes are at rest; morph targets at the
/// file's weights. Points and lines are skipped. Haptics come from the nodes' extras (docs/scenes.md).
///
/// Throws bad_input, one line naming file and fault: unreadable, malformed, out-of-range indices, non-finite positions,
/// a node loop, a scale of zero along one or two axes, haptics out of range, a required extension that is not supported
/// (by name; those of materials, textures and lights are harmless), an absent scene, compressed data that cannot be
/// unpacked or hold more than the file promises, more than 2 million triangles or 6 million vertices (instances
/// counted), 256 MiB of buffers (packed and unpacked together), 64 MiB of JSON or 50 000 nodes, meshes, primitives or
/// accessors.
///
/// Faults that do not affect the scene's geometry (textures, wrong min/max, meshes that no node shows) are warnings; if
/// the scene has no mesh at all, they are the error. A mesh with a scale of zero along all axes is hidden: it is left
/// out with a warning, or an error if no other is left. Unknown palpa extras, compressed data that hold fewer or more
/// vertices than promised, and hidden nodes (KHR_node_visibility), which are touchable nevertheless, are warnings.
/// Never blocks on devices or pipes.
Scene load_gltf(const std::filesystem::path& file, std::optional<int> scene_index = std::nullopt);

/// Around all meshes, metres; empty without any.
Box box_of(const Scene& scene);

}  // namespace palpa::geometry
