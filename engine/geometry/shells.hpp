// The pieces of a closed mesh, and which of them lies inside which.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bvh.hpp"
#include "geometry/mesh.hpp"

namespace palpa::geometry {

/// Triangles that hang together by edges.
struct Shell {
  std::uint32_t first = 0;            ///< its first triangle
  double volume = 0, area = 0;        ///< m^3, negative where it faces inwards; m^2
  std::vector<std::uint32_t> around;  ///< the shells that it lies inside of
};

struct Shells {
  std::vector<Shell> list;  ///< in the order of their first triangles
  std::vector<std::uint32_t> of_triangle;
};

/// `mesh` is closed and oriented, `twin` its twins.
Shells find_shells(const Mesh& mesh, std::span<const std::uint32_t> twin);

/// Fills `around`, by a ray from each shell, exactly. The shells must not meet.
void find_nesting(const Mesh& mesh, const Bvh& bvh, Shells& shells);

/// Turns the triangles of the shells that are marked.
void flip(Mesh& mesh, const Shells& shells, const std::vector<char>& marked);

}  // namespace palpa::geometry
