// Convex decomposition: any mesh as a union of convex parts, and how well that union matches it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/parts.hpp"
#include "geometry/parts/vhacd.hpp"

namespace palpa::geometry {

struct DecomposeOptions {
  std::uint32_t parts = 64;            ///< at most so many, 1 to most_parts
  std::uint32_t resolution = 400'000;  ///< V-HACD's voxels, least_voxels to most_voxels
  double error_percent = 1;            ///< a part this near to its voxels' volume is not cut further
};
inline constexpr std::uint32_t least_voxels = 1'000, most_voxels = 20'000'000;

/// What keeps a welded mesh from being decomposed, as the end of an error's line; empty when nothing does: a mesh
/// without triangles, without an extent along some axis, or larger than a kilometre or smaller than a micrometre.
std::string unfit_for_parts(const Mesh& mesh);

/// Convex parts of a welded mesh. A convex mesh is its own one part, exactly. Any other is cut by V-HACD: it may be
/// open (its holes are closed by fans), in several pieces, or pass through itself. nullopt when cancelled.
/// The same mesh and options give the same bytes. Throws failure(): nothing solid was found; without V-HACD (see
/// vhacd.hpp) for anything but a convex mesh.
std::optional<Parts> decompose(const Mesh& mesh, const DecomposeOptions& options, const Progress& progress = {});

/// How the parts' union compares with the mesh.
struct PartsReport {
  std::uint32_t parts = 0;
  std::optional<double> mesh_volume_m3;  ///< of a closed mesh
  double union_volume_m3 = 0;
  /// From points spread evenly over the union's surface to the mesh's, metres.
  double error_mean_m = 0, error_p95_m = 0, error_max_m = 0;
  double internal_share = 0;  ///< of the area of all parts' faces, what is no surface of the union, 0 to 1

  std::optional<double> volume_ratio() const {
    return mesh_volume_m3 ? std::optional(union_volume_m3 / *mesh_volume_m3) : std::nullopt;
  }
};
/// Deterministic: 40,000 points, stratified by area, from `seed`.
PartsReport measure(const Mesh& mesh, const Parts& parts, std::uint64_t seed);

}  // namespace palpa::geometry
