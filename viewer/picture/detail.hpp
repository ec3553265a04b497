// Coarser forms of a dense mesh. From afar, they cannot be told from the whole mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

/// Fewer triangles with the same vertices.
struct Detail {
  std::vector<std::uint32_t> corners;
  double error_m = 0;  ///< about how far its surface may lie from the mesh's
};

/// Each has about half as many triangles as the one before. Empty for a mesh that is not dense. The borders of open
/// meshes stay.
std::vector<Detail> coarser(std::span<const shader::ViewVertex> vertices, std::span<const std::uint32_t> corners);

/// How far off a surface may be drawn: half the width of the line along its outline. The outline is always that of the
/// whole mesh.
inline constexpr double least_pixels = 0.75;

}  // namespace palpa::viewer
