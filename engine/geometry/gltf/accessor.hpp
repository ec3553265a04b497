// Decodes numbers from bytes: strided, sparse, of any width.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/math.hpp"

namespace palpa::geometry::gltf {

/// `count` elements, `stride` bytes apart, the first at the start of `bytes`. Empty bytes mean zeros.
struct Column {
  std::span<const unsigned char> bytes;
  std::size_t count, stride;
  int component;            ///< glTF's number: 5120 i8, 5121 u8, 5122 i16, 5123 u16, 5125 u32, 5126 f32
  bool normalized = false;  ///< integers represent -1 to 1 or 0 to 1
};

/// Elements that replace elements of a column.
struct Sparse {
  Column indices, values;
};

/// The value of an integer in a normalized accessor: unsigned 0 to 1, signed -1 to 1 (glTF 2.0 section 3.6.2.2).
double normalized_value(double integer, int component);

/// `width` numbers per element, one element after the other. Floats are unchanged; 8- and 16-bit integers go through
/// normalized_value() if the column is normalized, and are unchanged otherwise. If a sparse index is out of range or
/// not ascending, `fault` gets it and the result is nullopt.
std::optional<std::vector<double>> read_numbers(const Column& column, std::size_t width,
                                                const std::optional<Sparse>& sparse, std::uint64_t& fault);

/// The same for unsigned integers of 8, 16 or 32 bits.
std::optional<std::vector<std::uint32_t>> read_unsigned(const Column& column, std::size_t width,
                                                        const std::optional<Sparse>& sparse, std::uint64_t& fault);

/// Triangles of `vertices` (0, 1, 2, ... or an index list) as list (mode 4), strip (5) or fan (6). Remaining vertices
/// of an incomplete triangle are dropped. glTF 2.0 section 3.7.2.1.
std::vector<glm::uvec3> triangles_of(int mode, std::span<const std::uint32_t> vertices);

/// The number of those triangles.
std::size_t triangle_count(int mode, std::size_t vertices);

}  // namespace palpa::geometry::gltf
