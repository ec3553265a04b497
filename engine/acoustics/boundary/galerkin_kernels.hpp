// The inner loops of the boundary elements' matrix (galerkin.hpp), for the processor in use.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

namespace palpa::acoustics {

/// A patch as seen from distant patches: three samples, each with its weight w of the three-point rule.
enum FarNumber : std::size_t { far_x, far_area = 3, far_u = 6, far_v = 9, far_numbers = 12 };
inline constexpr std::size_t far_lanes = 16;

/// Sixteen patches side by side, [sample][number][lane]: position, w times area vector, w times the tangents along u
/// and v. In metres from a common origin.
struct alignas(64) FarGroup {
  float of[3][far_numbers][far_lanes];
};

/// One patch. `area` is the length of w times the area vector.
struct FarPatch {
  float of[3][far_numbers];
  float area[3];
};

/// Nine complex numbers, row: test corner, column: trial corner.
using Block = std::array<std::complex<float>, 9>;

/// Blocks of a test patch with sixteen trial patches, [entry][re, im][lane].
struct alignas(64) FarBlocks {
  float of[9][2][far_lanes];
};

/// All blocks except the test function's half (galerkin.hpp), with three samples on either side. The result is
/// meaningless for a patch with itself.
void far_blocks(const FarPatch& test, const FarGroup& trial, float wave_number, FarBlocks& out);

/// A patch as a source of sound, sixteen patches side by side, [sample][number][lane]: position, weight times area
/// vector, and the pressure's real and imaginary part.
inline constexpr std::size_t layer_numbers = 8;
struct alignas(64) LayerGroup {
  float of[3][layer_numbers][far_lanes] = {};
};
struct alignas(64) LayerSums {
  float of[2][far_lanes];
};

/// The double layer of each of these patches at a point, in metres from the same origin, times e^{-ikR} of its distance
/// R from the origin, so that phases keep their precision however far the point is. The result is meaningless on a
/// patch.
void layer_sums(const std::array<float, 3>& point, const LayerGroup& patches, float wave_number, LayerSums& out);

/// Samples of two patches at once, padded with samples of weight 0.
struct PairTable {
  std::vector<float> u, v, other_u, other_v, weight;
  std::size_t size() const { return u.size(); }
};

/// Coefficients of a patch in metres; both patches of a pair have the same origin.
struct NearPatch {
  float c[6][3];
};

/// The block of two patches, sampled as in the table, and the block with their roles exchanged.
void near_blocks(const NearPatch& test, const NearPatch& trial, const PairTable& table, float wave_number, Block& block,
                 Block& exchanged);

}  // namespace palpa::acoustics
