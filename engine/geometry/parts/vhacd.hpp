// V-HACD 4.1, the paper's reference [13], behind a few lines: its header is compiled in vhacd.cpp alone, and palpa
// builds without it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Whether palpa was built with V-HACD.
bool has_vhacd();
/// What to do where it was not, for an error's line.
const char* how_to_get_vhacd();

struct VhacdOptions {
  std::uint32_t parts = 64;            ///< at most so many hulls
  std::uint32_t resolution = 400'000;  ///< voxels
  double error_percent = 1;            ///< a hull this near to its voxels' volume is not cut further
  std::uint32_t vertices = 64;         ///< at most so many per hull
};

/// Called some times a second with what is done, 0 to 1 and never less than before; false cancels.
using Progress = std::function<bool(double)>;

/// The corners of each hull, metres. Empty when cancelled. A cancel returns at once; V-HACD itself looks up only
/// between its stages, so a thread may go on for some seconds before it frees what it holds. `mesh` must have an
/// extent along each axis; what is inside is found by flooding from outside, which leaks through holes. Throws
/// failure() when palpa was built without V-HACD.
std::vector<std::vector<Vec3>> vhacd_hulls(const Mesh& mesh, const VhacdOptions& options, const Progress& progress);

}  // namespace palpa::geometry
