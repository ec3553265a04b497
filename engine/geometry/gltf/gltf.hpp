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

/// Which of a scene's meshes are the same but for where they are.
struct CopyOf {
  std::uint32_t mesh = 0;       ///< the same for all that show one mesh, in one pose of its bones and its targets
  Transform T_world_mesh{1.0};  ///< what took that mesh's vertices to the world; it may scale and mirror
};

/// One node's mesh, all its triangle primitives together, in the scene's coordinates (= world), not yet welded.
struct SceneMesh {
  std::string name;  ///< the node's name, else its mesh's, else "node N"; of an instance with its index: "name[i]"
  Mesh mesh;
  Haptics haptics{};             ///< of the node's extras; what it does not say is its nearest ancestor's that does
  std::optional<PartOf> part{};  ///< of the node's extras: this is no solid but a part of one
  std::optional<CopyOf> copy{};  ///< none where the node has weights of its own
};

struct Scene {
  std::string file;
  std::vector<SceneMesh> meshes;  ///< depth-first in the scene's node order
};

/// Reads `scene_index`, or the file's default scene, or scene 0; a file without scenes gives all root nodes. Triangle
/// lists, strips and fans, indexed by 8, 16 or 32 bits or not at all; sparse and interleaved accessors; quantized
/// positions (KHR_mesh_quantization); streams of draco (KHR_draco_mesh_compression; a plain copy beside one is
/// preferred) and packed buffer views (EXT_meshopt_compression; a fallback is never looked at); node hierarchies, TRS
/// and matrices, negative scale (triangles are turned so that they keep facing outwards), meshes that several nodes
/// show and nodes that show theirs many times (EXT_mesh_gpu_instancing, which skinned nodes ignore); skins in the pose
/// of the file's bones, which is the bind pose where the file's nodes are at rest; morph targets at the file's weights.
/// Points and lines are skipped. Haptics come from the nodes' extras (docs/scenes.md). Throws bad_input, one line
/// naming file and fault: unreadable, malformed, out-of-range indices, non-finite positions, a node loop, zero scale,
/// haptics out of range, a required extension that is not supported (by name; those of materials, textures and lights
/// are harmless), an absent scene, compressed data that cannot be unpacked or hold more than the file promises, more
/// than 2 million triangles or 6 million vertices (instances counted), 256 MiB of buffers (packed and unpacked
/// together), 64 MiB of JSON or 50 000 nodes, meshes, primitives or accessors. Faults without bearing on the scene's
/// geometry (textures, wrong min/max, meshes that no node shows) are warnings; in a file whose scene has no mesh at all
/// they are the error. Unknown palpa extras, compressed data that hold fewer or more vertices than promised, and hidden
/// nodes (KHR_node_visibility), which are touchable all the same, are warnings. Never blocks on devices or pipes.
Scene load_gltf(const std::filesystem::path& file, std::optional<int> scene_index = std::nullopt);

}  // namespace palpa::geometry
