// Convex parts: a solid as the union of convex pieces, the paper's own way (its section III-D).
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
  /// Two faces that look at each other across less than this belong to a cut and not to the surface, metres. At least
  /// the rounding of single-precision coordinates.
  double seam_m = 0;
};

/// The paper's Eq. (1) asks each part for itself (`keep`), so that a cut between two parts counts as surface. `drop`
/// measures the depth below the surface of the union.
enum class InternalFaces { drop, keep };
inline constexpr Word<InternalFaces> internal_faces_words[] = {{"drop", InternalFaces::drop},
                                                               {"keep", InternalFaces::keep}};

inline constexpr std::size_t most_parts = 1024;

/// The hull of `points`, rounded to single precision first, as a file stores them: a part that was written and read
/// again is the same bit for bit. nullopt where they are flat.
std::optional<Part> make_part(std::span<const Vec3> points);

/// The seam that rounding to single precision alone makes: what `Parts::seam_m` is at least.
double smallest_seam(std::span<const Part> parts);

/// Eq. (1) for one part: min over its planes of the distance below them, metres, positive inside.
double depth(const Part& part, const Vec3& point);

/// The surface of a union of parts as a soup of triangles: every face, less what lies inside another part or looks at
/// another part across less than the seam. Where faces of two parts lie in one another, looking the same way, the
/// first part's is kept, so that areas and volumes come out right. Triangles face outwards; the soup has no holes but
/// its triangles do not share edges.
struct UnionSurface {
  struct Triangle {
    Vec3 a, b, c;
    std::uint32_t part;   ///< whose face it is a piece of
    std::uint32_t plane;  ///< of that part
  };
  std::vector<Triangle> triangles;
};
/// Throws failure() where the parts overlap so much that finding what is left of their faces takes more than
/// most_cuts() cuts of a polygon by a plane: some ten times what decompositions need.
UnionSurface union_surface(const Parts& parts);
constexpr std::uint64_t most_cuts(std::uint64_t triangles) {
  return 4'000'000 + 1000 * triangles;
}

/// Square metres; cubic metres that the surface encloses.
double area(const UnionSurface& surface);
double volume(const UnionSurface& surface);

/// Depth of a point below the surface that `faces` calls for, metres: 0 where it lies in no part. Eq. (1) takes the
/// part that the point is least deep in. For single points.
double depth(const Parts& parts, InternalFaces faces, const Vec3& point);

/// Depth of a point below the surface of the union, metres: 0 where it lies in no part. Looks at every triangle: for
/// reports and tests.
double depth(const Parts& parts, const UnionSurface& surface, const Vec3& point);

}  // namespace palpa::geometry
