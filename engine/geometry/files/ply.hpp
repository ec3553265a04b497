// PLY point clouds and meshes, ascii and binary in either byte order.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

struct Ply {
  std::vector<Vec3> positions;        ///< metres, in file order
  std::vector<glm::uvec3> triangles;  ///< polygons are cut into fans; empty for a point cloud
};

/// Reads the `vertex` element's x, y, z (any numeric type) and, if present, the `face` element's vertex list. Other
/// elements and properties are skipped; everything after the last of the two is not read, and what no element promises
/// is warned of. Throws bad_input, one line naming file and fault (and line number for ascii): not a PLY, truncated,
/// counts that the file cannot hold, lines of an ascii file with more or fewer numbers than the header promises,
/// non-finite coordinates (which vertex), indices out of range, more than 16 million vertices or triangles. Never
/// blocks.
Ply read_ply(const std::filesystem::path& file);

enum class PlyFormat { ascii, binary };

/// Coordinates are float in binary (little-endian), and round-tripping decimals of type double in ascii. Throws
/// failure() if the file cannot be written completely.
void write_ply(const std::filesystem::path& file, std::span<const Vec3> positions,
               std::span<const glm::uvec3> triangles = {}, PlyFormat format = PlyFormat::binary);

}  // namespace palpa::geometry
