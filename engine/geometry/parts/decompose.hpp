// Convex decomposition: turns any mesh into a union of convex parts, and measures how well the union matches it.
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
  std::uint32_t parts = 64;            ///< maximum number, 1 to most_parts
  std::uint32_t resolution = 400'000;  ///< V-HACD's voxels, least_voxels to most_voxels
  double error_percent = 1;            ///< a part this close to its voxels' volume is not cut further
};
inline constexpr std::uint32_t least_voxels = 1'000, most_voxels = 20'000'000;

/// Why a welded mesh cannot be decomposed, as the end of an error's line; empty if it can: a mesh without triangles,
/// without an extent along some axis, or larger than a kilometre or smaller than a micrometre.
std::string unfit_for_parts(const Mesh& mesh);

/// Convex parts of a welded mesh. A convex mesh is its own only part, exactly. Any other mesh is cut by V-HACD: it may
/// be open (its holes are closed by fans), in several pieces, or pass through itself. Closed cavities stay empty,
/// unless they are too small for the voxels or there are too few parts. nullopt if `progress` ends it. The same mesh
/// and options give the same bytes. Throws failure() if nothing solid was found, if this thread is Cancellable and was
/// cancelled, and for any concave mesh if palpa has no V-HACD (see vhacd.hpp).
std::optional<Parts> decompose(const Mesh& mesh, const DecomposeOptions& options, const Progress& progress = {});

/// Metres.
struct Distances {
  double mean = 0, p95 = 0, max = 0;
};

/// Comparison of the parts' union with the mesh.
struct PartsReport {
  std::uint32_t parts = 0;
  std::optional<double> mesh_volume_m3;  ///< only of a closed mesh
  double union_volume_m3 = 0;
  Distances surface_error_m;  ///< to the mesh's surface, from points spread evenly over the union's surface
  Distances mesh_error_m;     ///< to the union's surface, from points spread evenly over the mesh's surface
  /// Shells of a closed mesh that face inwards, and how many of them the parts fill: their surface is on average
  /// farther from the union's than the parts' seam.
  std::uint32_t cavities = 0, filled_cavities = 0;
  double internal_share = 0;  ///< share of the area of all parts' faces that is not on the union's surface, 0 to 1

  std::optional<double> volume_ratio() const {
    return mesh_volume_m3 ? std::optional(union_volume_m3 / *mesh_volume_m3) : std::nullopt;
  }
};
/// Deterministic: 40,000 points on each surface, stratified by area, from `seed`.
PartsReport measure(const Mesh& mesh, const Parts& parts, std::uint64_t seed);

/// Whether a closed mesh has shells that face inwards.
bool has_cavities(const Mesh& mesh);

/// The warning about filled cavities, as the end of a line after the solid's name; empty if there are none.
std::string lost_cavities(const PartsReport& report);

}  // namespace palpa::geometry
