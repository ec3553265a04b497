// All checks of a glTF document that happen before its bytes are read.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf_document/container.hpp"
#include "geometry/gltf_document/meshopt.hpp"
#include "geometry/haptics.hpp"
#include "geometry/part_of.hpp"

namespace palpa::geometry::gltf {

/// The source of a buffer's bytes.
struct BufferSource {
  std::uint64_t length = 0;                                ///< required bytes; 0: the scene does not need this buffer
  std::string uri;                                         ///< a data URI or a relative path; empty: the BIN chunk
  std::optional<MeshoptBufferView> packed = std::nullopt;  ///< if set: unpack from another buffer instead
};

/// A primitive of the reduced document whose vertices and triangles are in a draco stream. It has no indices in the
/// document.
struct DracoSource {
  std::uint32_t mesh = 0, primitive = 0;              ///< its place in the reduced document
  std::uint32_t view = 0;                             ///< the buffer view of the stream
  std::uint64_t corners = 0;                          ///< of its triangles, as promised by the file
  std::map<std::string, std::uint32_t> attributes{};  ///< number in the stream, by the attribute's glTF name
};

/// A node that shows its mesh many times: the accessors of its instances' transforms in EXT_mesh_gpu_instancing.
struct Instancing {
  std::size_t count = 0;
  std::optional<std::uint32_t> translation{}, rotation{}, scale{};  ///< VEC3, VEC4 (x y z w), VEC3
};

/// The document reduced to what the chosen scene's triangles need, with every reference checked. Indices are the file's
/// own. Everything else is replaced by inert placeholders, so textures, animations and foreign extras can do no harm.
struct Document {
  std::string json;                    ///< valid glTF, buffer i at the URI "buffer i"
  std::vector<BufferSource> buffers;   ///< the file's, then one for each buffer view to unpack
  std::vector<DracoSource> draco;      ///< by mesh, then primitive
  std::vector<std::uint32_t> roots;    ///< nodes of the chosen scene
  std::vector<std::uint32_t> parents;  ///< of every node
  std::vector<Haptics> haptics;        ///< of every node that the scene shows, including values from its ancestors
  std::vector<std::optional<PartOf>> parts;        ///< the same: which nodes are parts of a solid
  std::map<std::uint32_t, Instancing> instancing;  ///< by node; skinned nodes have none
  /// Sparse accessors of indices without a buffer view. In the JSON they have one, because tinygltf wants it.
  std::vector<std::uint32_t> without_view;
  static constexpr std::uint32_t no_parent = 0xffffffffU;
};

/// The maximum size in bytes of all buffers together, packed and unpacked.
inline constexpr std::uint64_t most_buffer_bytes = 256 << 20;

/// Throws bad_input for any fault that prevents reading the chosen scene. A fault elsewhere in the file is a warning.
/// If the scene has no mesh, however, that fault is the error, because it may be the reason.
Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index);

}  // namespace palpa::geometry::gltf
