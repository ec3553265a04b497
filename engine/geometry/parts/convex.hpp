// Tests whether a closed mesh is convex, and finds its bounding planes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Points with dot(normal, x) < offset lie on the inner side. `normal` has unit length and points outwards.
struct Plane {
  Vec3 normal;
  double offset;
};

/// How far from a plane a vertex may lie and still count as on it, metres. This is the error of single-precision
/// coordinates: 1e-6 of the mesh's diagonal, or of its distance from the origin if that costs more digits.
double flatness_tolerance(const Mesh& mesh);
/// The same for a mesh in this box.
double flatness_tolerance(const Box& box);

/// One plane per facet. Connected triangles that lie in one plane within `tolerance` form one facet; slivers too thin
/// to have a direction join a neighbour. `mesh` is closed and oriented, `twin` its twins. Ordered by each facet's first
/// triangle.
struct Facets {
  std::vector<Plane> planes;
  std::vector<Vec3> centres;               ///< of the facets, metres
  std::vector<double> widths;              ///< of the facets across their longest extent, approximately, metres
  std::vector<std::uint32_t> of_triangle;  ///< each triangle's facet, or `no_facet` for slivers without one
  static constexpr std::uint32_t no_facet = 0xffffffffU;
};
Facets find_facets(const Mesh& mesh, std::span<const std::uint32_t> twin, double tolerance);

/// An edge at which the surface bends inwards.
struct ReflexEdge {
  std::array<std::uint32_t, 2> vertices;
  double angle;  ///< radians beyond flat, (0, pi]
};

/// Whether the surface bends inwards at an edge by more than rounding. A fast test that proves a mesh concave.
bool has_reflex_edge(const Mesh& mesh, std::span<const std::uint32_t> twin, double tolerance);

/// nullopt if the mesh is convex within `tolerance`, else its worst reflex edge. The mesh must be closed, oriented
/// outwards and in one piece. Takes linear time for strictly convex meshes, vertices x facets for small ones (see
/// convex.cpp).
std::optional<ReflexEdge> find_concavity(const Mesh& mesh, std::span<const std::uint32_t> twin, const Facets& facets,
                                         double tolerance);

}  // namespace palpa::geometry
