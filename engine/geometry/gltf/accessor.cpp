#include "geometry/gltf/accessor.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace palpa::geometry::gltf {
namespace {

// glTF is little-endian.
static_assert(std::endian::native == std::endian::little);

template <typename T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

double number_at(const unsigned char* at, int component, std::size_t i) {
  switch (component) {
    case 5120:
      return load<std::int8_t>(at + i);
    case 5121:
      return at[i];
    case 5122:
      return load<std::int16_t>(at + 2 * i);
    case 5123:
      return load<std::uint16_t>(at + 2 * i);
    default:
      return load<float>(at + 4 * i);
  }
}

std::uint32_t unsigned_at(const unsigned char* at, int component, std::size_t i) {
  switch (component) {
    case 5121:
      return at[i];
    case 5123:
      return load<std::uint16_t>(at + 2 * i);
    default:
      return load<std::uint32_t>(at + 4 * i);
  }
}

template <typename T, typename Read>
std::optional<std::vector<T>> read(const Column& column, std::size_t width, const std::optional<Sparse>& sparse,
                                   std::uint64_t& fault, const Read& read_at) {
  std::vector<T> values(column.count * width);
  const auto copy = [&](const Column& from, std::size_t source, std::size_t target) {
    const unsigned char* at = from.bytes.data() + source * from.stride;
    for (std::size_t i = 0; i < width; ++i)
      values[target * width + i] = read_at(at, from.component, i);
  };
  if (!column.bytes.empty()) {
    for (std::size_t i = 0; i < column.count; ++i)
      copy(column, i, i);
  }
  if (!sparse) return values;
  std::uint64_t least = 0;
  for (std::size_t i = 0; i < sparse->indices.count; ++i) {
    const unsigned char* at = sparse->indices.bytes.data() + i * sparse->indices.stride;
    const std::uint32_t index = unsigned_at(at, sparse->indices.component, 0);
    if (index < least || index >= column.count) {
      fault = index;
      return std::nullopt;
    }
    copy(sparse->values, i, index);
    least = std::uint64_t{index} + 1;
  }
  return values;
}

}  // namespace

std::optional<std::vector<double>> read_numbers(const Column& column, std::size_t width,
                                                const std::optional<Sparse>& sparse, std::uint64_t& fault) {
  auto values = read<double>(column, width, sparse, fault, number_at);
  if (values && column.normalized) {
    for (double& value : *values)
      value = normalized_value(value, column.component);
  }
  return values;
}

double normalized_value(double integer, int component) {
  switch (component) {
    case 5120:
      return std::max(integer / 127.0, -1.0);
    case 5121:
      return integer / 255.0;
    case 5122:
      return std::max(integer / 32767.0, -1.0);
    case 5123:
      return integer / 65535.0;
    default:
      return integer;
  }
}

std::optional<std::vector<std::uint32_t>> read_unsigned(const Column& column, std::size_t width,
                                                        const std::optional<Sparse>& sparse, std::uint64_t& fault) {
  return read<std::uint32_t>(column, width, sparse, fault, unsigned_at);
}

std::size_t triangle_count(int mode, std::size_t vertices) {
  if (mode == 4) return vertices / 3;
  return vertices < 3 ? 0 : vertices - 2;
}

std::vector<glm::uvec3> triangles_of(int mode, std::span<const std::uint32_t> v) {
  std::vector<glm::uvec3> triangles;
  const std::size_t count = triangle_count(mode, v.size());
  triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (mode == 4) {
      triangles.emplace_back(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    } else if (mode == 5) {
      triangles.emplace_back(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
    } else {
      triangles.emplace_back(v[i + 1], v[i + 2], v[0]);
    }
  }
  return triangles;
}

}  // namespace palpa::geometry::gltf
