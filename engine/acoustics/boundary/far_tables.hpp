// The patches of a body as distant patches see them: the samples from which the matrix entries of far pairs are
// computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Positions relative to `origin`.
std::vector<FarPatch> far_patches(const Patches& body, const Vec3& origin);

/// The selected patches, sixteen side by side. The last group is padded with distant patches without area.
void gather(std::span<const FarPatch> patches, std::span<const std::uint32_t> selected, std::vector<FarGroup>& groups);

/// Patches around each vertex, [first[v], first[v + 1]); ascending.
struct Around {
  std::vector<std::uint32_t> first, patches;
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return std::span(patches).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};
Around patches_around(const geometry::Mesh& mesh);

}  // namespace palpa::acoustics
