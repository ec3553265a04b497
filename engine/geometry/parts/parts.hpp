// Convex parts: a solid as the union of convex pieces, as in the paper (section III-D).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/words.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

/// One convex piece: the points with dot(normal, x) < offset for each of its planes.
struct Part {
  Mesh mesh;                  ///< its hull: closed, facing outwards
  std::vector<Plane> planes;  ///< one per facet; no vertex lies outside any of them
  std::vector<std::uint32_t> plane_of_triangle;
  Box bounds;
};

/// The pieces of one solid, which may overlap, abut or leave seams between them.
struct Parts {
  std::vector<Part> parts;
  /// Two faces that look at each other across less than this distance belong to a cut and not to the surface, metres.
  /// At least the rounding of single-precision coordinates.
  double seam_m = 0;
};

/// How faces inside the union count. With `keep`, each part is treated separately as in the paper's Eq. (1), so that a
/// cut between two parts counts as surface. `drop` measures the depth below the surface of the union.
enum class InternalFaces { drop, keep };
inline constexpr Word<InternalFaces> internal_faces_words[] = {{"drop", InternalFaces::drop},
                                                               {"keep", InternalFaces::keep}};

inline constexpr std::size_t most_parts = 1024;

/// The hull of `points`, which are first rounded to single precision, as in a file: a part that was written and read
/// again is the same bit for bit. nullopt if they are flat.
std::optional<Part> make_part(std::span<const Vec3> points);

/// The seam that rounding to single precision causes: the minimum of `Parts::seam_m`.
double smallest_seam(std::span<const Part> parts);

/// Eq. (1) for one part: the minimum over its planes of the distance below them, metres, positive inside.
double depth(const Part& part, const Vec3& point);

/// The surface of a union of parts as a set of triangles: every face, except what lies inside another part or looks at
/// another part across less than the seam. If faces of two parts coincide and look the same way, only the first part's
/// is kept, so that areas and volumes are correct. Triangles face outwards. The set has no holes, but its triangles do
/// not share edges.
struct UnionSurface {
  struct Face {
    std::uint32_t part;   ///< whose face the triangle is a piece of
    std::uint32_t plane;  ///< of that part
  };
  Mesh mesh;
  std::vector<Face> faces;  ///< one for each triangle
};
/// Throws failure() if the parts overlap so much that finding the visible rest of their faces takes more than
/// most_cuts() cuts of a polygon by a plane: about ten times what decompositions need.
UnionSurface union_surface(const Parts& parts);
constexpr std::uint64_t most_cuts(std::uint64_t triangles) {
  return 4'000'000 + 1000 * triangles;
}

/// Depth of a point below the surface that `faces` selects, metres: 0 outside all parts. Eq. (1) uses the part in which
/// the point is least deep. For single points.
double depth(const Parts& parts, InternalFaces faces, const Vec3& point);

/// Depth of a point below the surface of the union, metres: 0 outside all parts. Tests every triangle: for reports and
/// tests.
double depth(const Parts& parts, const UnionSurface& surface, const Vec3& point);

}  // namespace palpa::geometry
