// Which triangles of a cell's list stay in the list of one of the eight cells that it is divided into.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/surface/surface_contest.hpp"

namespace palpa::geometry {

/// Appends the triangles of `list` that no rival of the child's contest beats to `kept`, and returns their number.
/// `rivals_stay`: also appends the rivals' own triangles. The squared distances of triangle k from the CellSamples are
/// at `d2 + k * stride`; `d2` points to the child's first corner. The result is the same on every processor.
std::uint32_t keep_unbeaten(const Contest& contest, bool rivals_stay, std::span<const std::uint32_t> list,
                            const float* d2, std::size_t stride, std::vector<std::uint32_t>& kept);

}  // namespace palpa::geometry
