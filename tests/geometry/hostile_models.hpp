// Models whose cost would grow faster than their size.
#pragma once

#include <cstdint>

#include "geometry/mesh/mesh.hpp"
#include "gltf_builder.hpp"

namespace palpa::test::hostile {

/// Parallel rods along a diagonal of the axes: all their boxes overlap, the rods do not.
geometry::Mesh rods(int count);

/// Boxes within boxes, facing outwards and inwards in turn, or all outwards.
geometry::Mesh nested(int count, bool in_turn);

/// A fan of needles around one edge.
geometry::Mesh needles(std::uint32_t count);

/// A small box with a skin of this many joints, shown by as many nodes in the same place.
GltfBuilder many_bones(int joints);

}  // namespace palpa::test::hostile
