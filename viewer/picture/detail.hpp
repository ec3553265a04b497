// Coarser forms of a dense mesh: drawn from afar, nobody can tell them from the whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

/// Triangles of the same vertices, fewer of them.
struct Detail {
  std::vector<std::uint32_t> corners;
  double error_m = 0;  ///< how far its surface may lie from the mesh's, about
};

/// Each about half as many triangles as the one before; none of a mesh that is not dense. Edges of open meshes stay.
std::vector<Detail> coarser(std::span<const shader::ViewVertex> vertices, std::span<const std::uint32_t> corners);

/// How far off a surface may be drawn: half of the line along its outline, which is that of the whole mesh.
inline constexpr double least_pixels = 0.75;

}  // namespace palpa::viewer
