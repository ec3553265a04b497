// Buffer views compressed with the extension EXT_meshopt_compression (and, as far as it is the same,
// KHR_meshopt_compression).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::geometry::gltf {

enum class MeshoptMode : char { attributes, triangles, indices };
enum class MeshoptFilter : char { none, octahedral, quaternion, exponential };

/// The extension's data for one buffer view.
struct MeshoptBufferView {
  std::uint32_t buffer = 0;              ///< the buffer with the packed bytes
  std::uint64_t offset = 0, length = 0;  ///< their place in it
  std::uint64_t stride = 0, count = 0;   ///< unpacked: bytes of an element, elements
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
};

/// Why stride, count, mode and filter do not fit together; nullopt if they do.
std::optional<std::string> meshopt_fault(const MeshoptBufferView& view);

/// Unpacks the view's stride * count bytes; meshopt_fault(view) must be nullopt. `packed` is untrusted. Throws
/// bad_input naming the file if it does not match the view. Unpacked indices may be any numbers.
std::vector<unsigned char> unpack_meshopt(const std::string& file, const MeshoptBufferView& view,
                                          std::span<const unsigned char> packed);

}  // namespace palpa::geometry::gltf
