// The matrix blocks of neighbouring patches, for which three samples on either side are too few.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Patches whose centroids are nearer than this many times the longest side of either are sampled more finely. Above
/// 4/3, so that patches that touch are included.
inline constexpr double near_reach = 2.2;

/// By test patch: entries first[test] to first[test + 1] are its trial patches (ascending, including itself) and their
/// blocks of the matrix (galerkin.hpp), including the test function's half.
struct NearPairs {
  std::vector<std::uint32_t> first, trial;
  std::vector<Block> blocks;
  /// The first two patches that are so close to each other that their blocks have lost precision (near_rules.hpp).
  std::optional<std::array<std::uint32_t, 2>> unresolved;
};
/// Throws GivenUp soon after `give_up` becomes true.
NearPairs near_pairs(const Patches& body, double wave_number, const std::atomic<bool>* give_up = nullptr);

/// Warns if pairs.unresolved has a value.
void warn_of_unresolved(const NearPairs& pairs);

/// The number of entries: about 40 per face of an even mesh.
std::uint64_t near_pair_count(const geometry::Mesh& mesh);

}  // namespace palpa::acoustics
