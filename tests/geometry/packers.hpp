// Compressed and quantized glTF files made in tests, with the libraries that real writers use.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/gltf_builder.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::test {

/// Positions as integers of `component` (5120 i8, 5121 u8, 5122 i16, 5123 u16), normalized or not; the node's scale and
/// translation restore them. Each vertex is within `step` of its original place, per axis.
struct Quantized {
  GltfBuilder file;
  double step = 0;
};
Quantized quantized_file(const geometry::Mesh& mesh, int component, bool normalized);

/// A draco stream: positions with `bits` per axis (0: as floats), as attribute 7. With `skin` also joints (8, all 1)
/// and weights (9), quarter by quarter.
std::vector<unsigned char> draco_stream(const geometry::Mesh& mesh, int bits, bool sequential, bool skin = false);
/// A file whose only primitive is that stream; `vertices` and `triangles` are the counts of its accessors.
GltfBuilder draco_file(const std::vector<unsigned char>& stream, std::size_t vertices, std::size_t triangles);

struct MeshoptChoice {
  bool sequence = false;     ///< indices as INDICES in place of TRIANGLES
  bool exponential = false;  ///< positions by the filter EXPONENTIAL (steps of 2^-20) in place of plain floats
  int index_size = 4;
  std::string extension = "EXT_meshopt_compression";
  bool flagged = true;  ///< the fallback buffer is marked as one
};
GltfBuilder meshopt_file(const geometry::Mesh& mesh, const MeshoptChoice& choice = {});

/// Whether the triangles of one mesh are those of the other, corner by corner within `tolerance` per axis, in any
/// order.
bool same_triangles(const geometry::Mesh& a, const geometry::Mesh& b, double tolerance);

}  // namespace palpa::test
