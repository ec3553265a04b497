// Everything that is checked about a glTF document before its bytes are touched.
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

/// Where a buffer's bytes come from.
struct BufferSource {
  std::uint64_t length = 0;                                ///< bytes wanted; 0: the scene does not need this buffer
  std::string uri;                                         ///< a data URI or a relative path; empty: the BIN chunk
  std::optional<MeshoptBufferView> packed = std::nullopt;  ///< instead of either: to be unpacked from another buffer
};

/// A primitive of the reduced document whose vertices and triangles are in a stream of draco. It has no indices there.
struct DracoSource {
  std::uint32_t mesh = 0, primitive = 0;              ///< its place in the reduced document
  std::uint32_t view = 0;                             ///< the buffer view of the stream
  std::uint64_t corners = 0;                          ///< of its triangles, as many as the file promises
  std::map<std::string, std::uint32_t> attributes{};  ///< number within the stream, by glTF's name of the attribute
};

/// A node that shows its mesh many times: accessors of what EXT_mesh_gpu_instancing says about each instance.
struct Instancing {
  std::size_t count = 0;
  std::optional<std::uint32_t> translation{}, rotation{}, scale{};  ///< VEC3, VEC4 (x y z w), VEC3
};

/// The document reduced to what the chosen scene's triangles need, each reference in it checked. Indices are the file's
/// own; what is not needed is replaced by inert stand-ins, so neither textures nor animations nor other
/// people's extras can do harm.
struct Document {
  std::string json;                    ///< glTF again, buffer i at the URI "buffer i"
  std::vector<BufferSource> buffers;   ///< the file's, then one for each buffer view that has to be unpacked
  std::vector<DracoSource> draco;      ///< by mesh, then primitive
  std::vector<std::uint32_t> roots;    ///< nodes of the chosen scene
  std::vector<std::uint32_t> parents;  ///< of every node
  std::vector<Haptics> haptics;  ///< of every node that the scene shows, with what it takes over from its ancestors
  std::vector<std::optional<PartOf>> parts;        ///< likewise: which nodes are parts of a solid
  std::map<std::uint32_t, Instancing> instancing;  ///< by node; none of a skinned one
  static constexpr std::uint32_t no_parent = 0xffffffffU;
};

/// The largest buffers that palpa reads, bytes, all together, packed and unpacked.
inline constexpr std::uint64_t most_buffer_bytes = 256 << 20;

/// Throws bad_input for whatever keeps the chosen scene from being read. A fault elsewhere in the file is a warning;
/// but where the scene has no mesh, that fault is the error, since it may be the reason.
Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index);

}  // namespace palpa::geometry::gltf
