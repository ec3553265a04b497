// What patches do to patches next to them, where three samples on either side are too few.
#pragma once

#include <cstdint>
#include <vector>

#include "acoustics/galerkin_kernels.hpp"
#include "acoustics/patches.hpp"

namespace palpa::acoustics {

/// By test patch: entries first[test] to first[test + 1] are its trial patches, ascending, itself among them, and the
/// blocks of the matrix that they give (galerkin.hpp), the test function's half included.
struct NearPairs {
  std::vector<std::uint32_t> first, trial;
  std::vector<Block> blocks;
};
NearPairs near_pairs(const Patches& body, double wave_number);

/// How many there are per face of an even mesh, about.
inline constexpr std::uint64_t near_pairs_per_face = 60;

}  // namespace palpa::acoustics
