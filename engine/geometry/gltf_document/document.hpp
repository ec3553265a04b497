// A glTF document as far as the chosen scene needs it, with every reference checked before any of its bytes are read.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf_document/container.hpp"
#include "geometry/gltf_document/meshopt.hpp"
#include "geometry/haptics.hpp"
#include "geometry/part_of.hpp"

namespace palpa::geometry::gltf {

/// The maximum size in bytes of all buffers together, packed and unpacked.
inline constexpr std::uint64_t most_buffer_bytes = 256 << 20;

/// The source of a buffer's bytes.
struct BufferSource {
  std::uint64_t length = 0;                   ///< required bytes; 0: the scene does not need this buffer
  std::string uri{};                          ///< a data URI or a relative path; empty: the BIN chunk
  std::optional<MeshoptBufferView> packed{};  ///< if set: unpack from an earlier buffer instead
};

/// Bytes of a buffer, all within it.
struct View {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0, length = 0;
  std::uint64_t stride = 0;  ///< from one element to the next; 0: not given
};

/// glTF's numbers for signed, unsigned and floating-point components by their bits.
enum class Component : std::uint16_t { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

/// In bytes; 0 for other numbers.
std::uint64_t size_of(Component component);

/// Elements that replace those of an accessor.
struct Sparse {
  std::uint64_t count = 0;
  Component component = Component::u8;  ///< of the indices
  View indices{}, values{};
};

/// Elements of `width` numbers each.
struct Accessor {
  std::uint64_t count = 0, width = 0;
  Component component = Component::f32;
  bool normalized = false;     ///< integers represent -1 to 1 or 0 to 1
  std::optional<View> data{};  ///< with a stride; nullopt: all zeros, or in a draco stream
  std::optional<Sparse> sparse{};
  std::vector<double> min{}, max{};  ///< of positions, if the file has them
};

/// A draco stream.
struct DracoSource {
  std::uint32_t view = 0;  ///< its number, for messages
  View bytes{};
  std::map<std::string, std::uint32_t> attributes{};  ///< number in the stream, by the attribute's glTF name
};

/// The effect of a morph target: an accessor's values, times the weight, are added to the positions.
struct Displacement {
  std::uint32_t accessor = 0;
  double weight = 0;
};

/// Triangles. Accessors are given by their indices.
struct Primitive {
  int mode = 4;                                         ///< 4: list, 5: strip, 6: fan
  std::uint64_t vertices = 0, corners = 0;              ///< promised numbers of vertices and of triangle corners
  std::map<std::string, std::uint32_t> attributes{};    ///< POSITION, JOINTS_n and WEIGHTS_n
  std::optional<std::uint32_t> indices{};               ///< never with a stream
  std::vector<std::optional<std::uint32_t>> targets{};  ///< of each morph target: what it adds to the positions
  std::vector<Displacement> displacements{};            ///< by the mesh's own weights
  std::optional<DracoSource> stream{};                  ///< with vertices and triangles
};

struct MeshSource {
  std::string name{};
  std::vector<Primitive> primitives{};
};

/// Those of the morph targets that do not have the weight 0. `weights` may be empty, or has one for each target.
std::vector<Displacement> displacements_of(const Primitive& primitive, const std::vector<double>& weights);

struct Skin {
  std::vector<std::uint32_t> joints{};  ///< nodes
  std::optional<std::uint32_t> inverse_bind_matrices{};
};

/// A node that shows its mesh many times: the accessors of its instances' transforms in EXT_mesh_gpu_instancing.
struct Instancing {
  std::size_t count = 0;
  std::optional<std::uint32_t> translation{}, rotation{}, scale{};  ///< VEC3, VEC4 (x y z w), VEC3
};

struct Node {
  static constexpr std::uint32_t none = 0xffffffffU;

  std::uint32_t parent = none;
  std::string name{};
  Transform T_world_node{1.0};
  std::optional<std::uint32_t> mesh{}, skin{};
  std::vector<double> weights{};           ///< of its mesh's morph targets, in place of the mesh's; may be empty
  Haptics haptics{};                       ///< including values from its ancestors
  std::optional<PartOf> part{};            ///< if set, it is a part of a solid
  std::optional<Instancing> instancing{};  ///< never with a skin
};

/// Indices are the file's own. What the chosen scene does not need is empty.
struct Document {
  std::vector<BufferSource> buffers{};  ///< the file's, then one for each buffer view to unpack
  std::vector<Accessor> accessors{};
  std::vector<MeshSource> meshes{};
  std::vector<Skin> skins{};
  std::vector<Node> nodes{};
  std::vector<std::uint32_t> shown{};  ///< the scene's nodes with a mesh, depth-first
};

/// Throws bad_input for any fault that prevents reading the chosen scene. A fault elsewhere in the file is a warning.
/// If the scene has no mesh, however, that fault is the error, because it may be the reason.
Document read_document(const std::string& file, const Container& container, std::optional<int> scene_index);

}  // namespace palpa::geometry::gltf
