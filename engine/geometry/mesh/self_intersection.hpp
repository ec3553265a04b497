// Does a mesh pass through itself?
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Whether two triangles of a welded mesh have a point in common besides the vertex or edge that they share; triangles
/// that share an edge do where one is folded flat onto the other. Exact (predicates.hpp); touching counts.
bool triangles_meet(const Mesh& mesh, std::uint32_t a, std::uint32_t b);

struct Crossing {
  std::array<std::uint32_t, 2> triangles;  ///< ascending
  Vec3 where{0};                           ///< a point near both
};

/// The most pairs of triangles with overlapping boxes that are looked at in a mesh: models have some 20 per triangle.
constexpr std::uint64_t most_pairs(std::uint64_t triangles) {
  return 10'000'000 + 60 * triangles;
}

/// The first pair of triangles that meet, in the order of `bvh`, the tree of the welded `mesh`; the same one for any
/// number of threads. Triangles without area are left out: what crosses them crosses their neighbours. Throws failure()
/// where more than `most` pairs would have to be looked at before one is found.
std::optional<Crossing> find_self_intersection(const Mesh& mesh, const Bvh& bvh, std::uint64_t most);

}  // namespace palpa::geometry
