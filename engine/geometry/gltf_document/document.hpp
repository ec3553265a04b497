// A glTF document reduced to what the chosen scene needs, with everything checked before any of its bytes are read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf_document/container.hpp"
#include "geometry/gltf_document/json.hpp"
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

struct Document {
  static constexpr std::uint32_t no_parent = 0xffffffffU;

  /// Valid glTF, except that it has no list of buffers and that items which the scene does not need are empty. Indices
  /// are the file's own, but a mesh has only its primitives of triangles. A primitive has the extension for draco only
  /// if palpa must use it. Buffer views are unpacked ones.
  Json json{};
  std::vector<BufferSource> buffers{};         ///< the file's, then one for each buffer view to unpack
  std::vector<std::uint32_t> shown{};          ///< the scene's nodes with a mesh, depth-first
  std::vector<std::uint32_t> parents{};        ///< of each node
  std::vector<Haptics> haptics{};              ///< of each node of the scene, including values from its ancestors
  std::vector<std::optional<PartOf>> parts{};  ///< the same; if set, the node is a part of a solid
};

/// Throws bad_input for any fault that prevents reading the chosen scene. A fault elsewhere in the file is a warning.
/// If the scene has no mesh, however, that fault is the error, because it may be the reason.
Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index);

}  // namespace palpa::geometry::gltf
