// Products of complex matrices whose real and imaginary parts lie apart, for the processor in use. All sums run in the
// same order on every call.
#pragma once

#include <cstddef>

namespace palpa::acoustics {

/// Rows are processed this many at a time: their number, and all strides, are multiples of it.
inline constexpr std::size_t split_lanes = 16;

/// Column after column: `stride` floats of real parts, then as many imaginary ones.
struct SplitMatrix {
  const float* of;
  std::size_t rows, columns, stride;
};

/// Vectors side by side, each like a column of a SplitMatrix.
struct SplitVectors {
  float* of;
  std::size_t stride;
};

/// y += m f, for `count` vectors. The factor of column c for vector v is factors[2 (c count + v)], followed by its
/// imaginary part.
void add_columns(const SplitMatrix& m, const float* factors, std::size_t count, const SplitVectors& y);

/// f = m^T x, not conjugated, in the same form.
void dot_columns(const SplitMatrix& m, const SplitVectors& x, std::size_t count, float* factors);

}  // namespace palpa::acoustics
