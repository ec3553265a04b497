// A mesh's triangles as the distance query wants them.
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

/// How narrow a triangle may be before its direction means nothing, given flatness_tolerance() of its mesh: a tenth of
/// it, 1e-7 of the mesh's diagonal.
inline double needle_width(double flatness) {
  return flatness / 10;
}

/// In `order` (a permutation of the mesh's triangles), relative to `centre`. `mesh` is closed and oriented, `twin` its
/// twins.
///
/// A triangle less than `needle` metres wide has no direction that could be trusted: it takes the one of its neighbour
/// across its longest side, as if the two had been one triangle; its distance changes by less than its width. Signs:
/// angle-weighted pseudonormals (Baerentzen and Aanaes 2005), but where the surface bends by more than a right angle a
/// point nearest to the edge is outside if the edge is convex and inside if it is reflex, whatever rounding does;
/// corners alike. Where two fans of triangles touch in one vertex each has its own pseudonormal.
SurfaceTriangles make_surface_triangles(const Mesh& mesh, std::span<const std::uint32_t> twin,
                                        std::span<const std::uint32_t> order, const Vec3& centre, double needle);

}  // namespace palpa::geometry
