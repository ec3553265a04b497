// A mesh's triangles in the form that the distance query needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "shaders/touch/contacts/surface.h"

namespace palpa::geometry {

struct SurfaceTriangles {
  std::vector<shader::SurfaceTriangle> triangles;
  std::vector<shader::SurfaceSigns> signs;
  std::vector<shader::vec4> corners;
};

/// The width below which a triangle's direction is meaningless, given flatness_tolerance() of its mesh: a tenth of it,
/// 1e-7 of the mesh's diagonal.
inline double needle_width(double flatness) {
  return flatness / 10;
}

/// The triangles in `order` (a permutation of the mesh's triangles), relative to `centre`. `mesh` is closed and
/// oriented, `twin` its twins.
///
/// A triangle less than `needle` metres wide has no reliable direction. It takes that of its neighbour across its
/// longest side, as if the two were one triangle; its distance changes by less than its width. Signs: angle-weighted
/// pseudonormals (Baerentzen and Aanaes 2005). However, at an edge where the surface bends by more than a right angle,
/// a point nearest to the edge is outside if the edge is convex and inside if it is reflex, regardless of rounding; the
/// same holds for corners. If two fans of triangles touch in one vertex, each has its own pseudonormal.
SurfaceTriangles make_surface_triangles(const Mesh& mesh, std::span<const std::uint32_t> twin,
                                        std::span<const std::uint32_t> order, const Vec3& centre, double needle);

}  // namespace palpa::geometry
