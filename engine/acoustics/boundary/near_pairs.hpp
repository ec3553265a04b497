// What patches do to patches next to them, where three samples on either side are too few.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/boundary/patches.hpp"

namespace palpa::acoustics {

/// By test patch: entries first[test] to first[test + 1] are its trial patches, ascending, itself among them, and the
/// blocks of the matrix that they give (galerkin.hpp), the test function's half included.
struct NearPairs {
  std::vector<std::uint32_t> first, trial;
  std::vector<Block> blocks;
  /// The first two that lie so close to each other that their blocks have lost digits (near_rules.hpp).
  std::optional<std::array<std::uint32_t, 2>> unresolved;
};
/// Throws GivenUp soon after `give_up` became true.
NearPairs near_pairs(const Patches& body, double wave_number, const std::atomic<bool>* give_up = nullptr);

/// How many entries that has: some 40 per face of an even mesh.
std::uint64_t near_pair_count(const geometry::Mesh& mesh);

}  // namespace palpa::acoustics
