// Meshes stored by the extension KHR_draco_mesh_compression: connectivity and attributes in one compressed stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::geometry::gltf {

/// One attribute that is wanted of a stream.
struct DracoAttribute {
  std::uint32_t id;   ///< the number that the stream knows it by
  std::size_t width;  ///< components: 3 for positions
};

struct DracoMesh {
  std::size_t points = 0;
  std::vector<glm::uvec3> triangles;  ///< each index below `points`
  std::vector<std::vector<double>>
      values;  ///< of each wanted attribute, `width` per point; integers as they are stored
};

/// What the attributes of all of a file's streams may take while they are decoded, bytes.
inline constexpr std::uint64_t most_draco_bytes = 512 << 20;

/// Decodes a stream of bitstream version 2.2 (glTF's), which may come from anybody: truncated, wrong or meant to fill
/// the memory. The file promises `points` and `triangles`. Streams that claim more triangles, or more points than both
/// these and those triangles' corners, or whose attributes take more than `spare_bytes` (from which what they take is
/// subtracted), are refused before anything of that size is allocated or done. nullopt, and `fault` a clause in words,
/// for a stream that cannot be decoded or lacks a wanted attribute.
std::optional<DracoMesh> decode_draco(std::span<const unsigned char> stream,
                                      const std::vector<DracoAttribute>& attributes, std::size_t points,
                                      std::size_t triangles, std::uint64_t& spare_bytes, std::string& fault);

}  // namespace palpa::geometry::gltf
