// Everything that is checked about a glTF document before its bytes are touched.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf_container.hpp"

namespace palpa::geometry::gltf {

/// Where a buffer's bytes come from.
struct BufferSource {
  std::uint64_t length = 0;  ///< bytes wanted; 0: the scene does not need this buffer
  std::string uri;           ///< a data URI or a relative path; empty: the BIN chunk
};

/// The document reduced to what the chosen scene's triangles need, each reference in it checked. Indices are the file's
/// own; what is not needed is replaced by inert stand-ins, so neither textures nor animations nor extras can do harm.
struct Document {
  std::string json;  ///< glTF again, buffer i at the URI "buffer i"
  std::vector<BufferSource> buffers;
  std::vector<std::uint32_t> roots;    ///< nodes of the chosen scene
  std::vector<std::uint32_t> parents;  ///< of every node
  static constexpr std::uint32_t no_parent = 0xffffffffU;
};

/// The largest buffers that palpa reads, bytes, all together.
inline constexpr std::uint64_t most_buffer_bytes = 256 << 20;

/// Throws bad_input for whatever keeps the chosen scene from being read. A fault elsewhere in the file is a warning;
/// but where the scene has no mesh, that fault is the error, since it may be the reason.
Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index);

}  // namespace palpa::geometry::gltf
