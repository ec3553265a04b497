// The table that the contacts pass and its twin read for solids made of convex parts. For each cell of a solid's box,
// it lists the parts that may contain a point and the pieces of their union's surface that can be the nearest.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/parts/parts.hpp"
#include "shaders/shared/shared.h"

namespace palpa::touch {

/// One solid's place in the table and its box, all relative to `centre`.
struct PartsGrid {
  glm::vec3 centre{}, low{}, high{};  ///< world, metres; then the box, a little too large
  glm::vec3 cells_per_metre{};
  std::uint32_t cells_per_axis = 0;
  std::uint32_t base = 0;  ///< of its header, in words
};

/// The maximum number of looks at planes and triangles for filling the cells of one solid: about ten times as many as
/// decompositions need.
constexpr std::uint64_t most_looks(std::uint64_t planes_and_triangles) {
  return 30'000'000 + 3000 * planes_and_triangles;
}

/// Appends one solid to `words`, which shaders/touch/contacts/parts_depth.h describes. Single precision relative to the
/// solid's centre: the depth agrees with double precision within 1 micrometre (solids up to 3 m). With
/// `InternalFaces::drop`, the depth is the distance to the surface of the union; with `keep`, it is Eq. (1) of each
/// part alone. Throws bad_usage for parts without planes or a box that is not finite, and failure() if parts overlap so
/// much that most_looks() is exceeded.
PartsGrid add_parts(std::vector<shader::uvec4>& words, const geometry::Parts& parts, geometry::InternalFaces faces);

}  // namespace palpa::touch
