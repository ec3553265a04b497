// Meshes stored by the extension KHR_draco_mesh_compression: connectivity and attributes in one compressed stream.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::geometry::gltf {

/// One attribute to decode from a stream.
struct DracoAttribute {
  std::uint32_t id;   ///< the attribute's number in the stream
  std::size_t width;  ///< components: 3 for positions

  auto operator<=>(const DracoAttribute&) const = default;  // NOLINT(modernize-use-nullptr): of the compiler's own code
};

struct DracoMesh {
  std::size_t points = 0;
  std::vector<glm::uvec3> triangles;  ///< each index below `points`
  std::vector<std::vector<double>>
      values;  ///< of each requested attribute, `width` per point; integers are not normalised
};

/// The maximum size in bytes of the decoded attributes of all streams in a file.
inline constexpr std::uint64_t most_draco_bytes = 512 << 20;

/// Decodes a stream of bitstream version 2.2 (glTF's). The stream is untrusted: it may be truncated, wrong or meant to
/// fill the memory. The file promises `points` and `triangles`. Before anything of that size is allocated or done,
/// streams are refused that claim more triangles, more points than both the promised points and the corners of the
/// promised triangles, or attributes larger than `spare_bytes` (the decoded size is subtracted from it). If a stream
/// cannot be decoded or lacks a requested attribute, returns nullopt and sets `fault` to a clause in words.
std::optional<DracoMesh> decode_draco(std::span<const unsigned char> stream,
                                      const std::vector<DracoAttribute>& attributes, std::size_t points,
                                      std::size_t triangles, std::uint64_t& spare_bytes, std::string& fault);

}  // namespace palpa::geometry::gltf
