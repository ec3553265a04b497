// Detects meshes that intersect themselves.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Whether two triangles of a welded mesh have a point in common besides their shared vertex or edge. Triangles that
/// share an edge do if one is folded flat onto the other. Exact (predicates.hpp); touching counts.
bool triangles_meet(const Mesh& mesh, std::uint32_t a, std::uint32_t b);

struct Crossing {
  std::array<std::uint32_t, 2> triangles;  ///< ascending
  Vec3 where{0};                           ///< a point near both
};

/// The maximum number of pairs of triangles with overlapping boxes to test in a mesh: models have about 20 per
/// triangle.
constexpr std::uint64_t most_pairs(std::uint64_t triangles) {
  return 10'000'000 + 60 * triangles;
}

/// The first pair of triangles that meet, in the order of `bvh`, the tree of the welded `mesh`; the result is the same
/// for any number of threads. Triangles with zero area are skipped: what crosses them also crosses their neighbours.
/// Throws failure() if more than `most` pairs would have to be tested before one is found.
std::optional<Crossing> find_self_intersection(const Mesh& mesh, const Bvh& bvh, std::uint64_t most);

}  // namespace palpa::geometry
