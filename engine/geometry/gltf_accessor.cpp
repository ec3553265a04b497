#include "geometry/gltf_accessor.hpp"

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

Vec3 vec3_at(const Column& column, std::size_t i) {
  if (column.bytes.empty()) return Vec3(0);
  const unsigned char* at = column.bytes.data() + i * column.stride;
  return {load<float>(at), load<float>(at + 4), load<float>(at + 8)};
}

std::uint32_t unsigned_at(const Column& column, std::size_t i) {
  const unsigned char* at = column.bytes.data() + i * column.stride;
  switch (column.component) {
    case 5121:
      return *at;
    case 5123:
      return load<std::uint16_t>(at);
    default:
      return load<std::uint32_t>(at);
  }
}

template <typename T, typename Read>
std::optional<std::vector<T>> read(const Column& column, const std::optional<Sparse>& sparse, std::uint64_t& fault,
                                   const Read& at) {
  std::vector<T> values(column.count);
  for (std::size_t i = 0; i < column.count; ++i)
    values[i] = at(column, i);
  if (!sparse) return values;
  std::uint64_t least = 0;
  for (std::size_t i = 0; i < sparse->indices.count; ++i) {
    const std::uint32_t index = unsigned_at(sparse->indices, i);
    if (index < least || index >= column.count) {
      fault = index;
      return std::nullopt;
    }
    values[index] = at(sparse->values, i);
    least = std::uint64_t{index} + 1;
  }
  return values;
}

}  // namespace

std::optional<std::vector<Vec3>> read_vec3(const Column& column, const std::optional<Sparse>& sparse,
                                           std::uint64_t& fault) {
  return read<Vec3>(column, sparse, fault, vec3_at);
}

std::optional<std::vector<std::uint32_t>> read_unsigned(const Column& column, const std::optional<Sparse>& sparse,
                                                        std::uint64_t& fault) {
  return read<std::uint32_t>(column, sparse, fault, unsigned_at);
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
