// V-HACD 4.1, the paper's reference [13], behind a small interface: only vhacd.cpp compiles its header, and palpa also
// builds without it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Advice for an error's line if palpa was built without it.
const char* how_to_get_vhacd();

struct VhacdOptions {
  std::uint32_t parts = 64;            ///< maximum number of hulls
  std::uint32_t resolution = 400'000;  ///< voxels
  double error_percent = 1;            ///< a hull this close to its voxels' volume is not cut further
  std::uint32_t vertices = 64;         ///< maximum number per hull
  bool cavities = false;               ///< keeps closed cavities empty; `mesh` is then closed and faces outwards
};

/// Called a few times per second with the progress, 0 to 1 and never decreasing; returning false cancels.
using Progress = std::function<bool(double)>;

/// The corners of each hull, metres. Empty if cancelled. A cancel returns at once, but V-HACD only notices it between
/// its stages, so a thread may continue for some seconds before it frees its memory. `mesh` must have an extent along
/// each axis. The inside is found by flooding from outside, which leaks through holes and fills cavities; with
/// `cavities`, by rays from each voxel. Throws failure() if palpa was built without V-HACD.
std::vector<std::vector<Vec3>> vhacd_hulls(const Mesh& mesh, const VhacdOptions& options, const Progress& progress);

}  // namespace palpa::geometry
