// Which triangles of a cell's list stay in the list of one of the eight cells that it is divided into.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/surface/surface_contest.hpp"

namespace palpa::geometry {

/// Appends those of `list` to `kept` that no rival of the child's contest beats, and returns their number. Triangle k's
/// squared distances from the CellSamples are at `d2 + k * stride`, where `d2` is at the child's first corner.
/// `rivals_stay`: also the rivals' own triangles. The same on every processor.
std::uint32_t keep_unbeaten(const Contest& contest, bool rivals_stay, std::span<const std::uint32_t> list,
                            const float* d2, std::size_t stride, std::vector<std::uint32_t>& kept);

}  // namespace palpa::geometry
