#include "geometry/gltf/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <tuple>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::geometry::gltf {
namespace {

// glTF is little-endian.
static_assert(std::endian::native == std::endian::little);

template <typename T, typename Stored>
T load(const unsigned char* element, std::size_t i) {
  Stored value;
  std::memcpy(&value, element + i * sizeof value, sizeof value);
  return static_cast<T>(value);
}

// The number `i` of an element.
template <typename T>
T number_at(const unsigned char* element, int component, std::size_t i) {
  switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load<T, std::int8_t>(element, i);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<T, std::uint8_t>(element, i);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load<T, std::int16_t>(element, i);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<T, std::uint16_t>(element, i);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<T, std::uint32_t>(element, i);
    default:
      return load<T, float>(element, i);
  }
}

std::size_t component_size(int component) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component)));
}

double normalized_value(double integer, int component) {
  if (component > TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return integer;
  const bool is_signed = component == TINYGLTF_COMPONENT_TYPE_BYTE || component == TINYGLTF_COMPONENT_TYPE_SHORT;
  const unsigned most = (1U << (8 * component_size(component) - (is_signed ? 1 : 0))) - 1;
  return std::max(integer / most, -1.0);
}

}  // namespace

void Values::fail(int accessor, const std::string& fault) const {
  throw bad_input(file_, fmt::format("accessor {}: {}", accessor, fault));
}

std::span<const unsigned char> Values::bytes(int v) const {
  const tinygltf::BufferView& view = at(model_.bufferViews, v);
  return std::span(at(model_.buffers, view.buffer).data).subspan(view.byteOffset, view.byteLength);
}

template <typename T>
std::vector<T> Values::read(int accessor, std::size_t most) const {
  const tinygltf::Accessor& a = at(model_.accessors, accessor);
  const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)));
  const std::size_t count = std::min(a.count, most), size = width * component_size(a.componentType);
  std::vector<T> values(count * width);
  const auto copy = [&](const unsigned char* element, std::size_t target) {
    for (std::size_t i = 0; i < width; ++i)
      values[target * width + i] = number_at<T>(element, a.componentType, i);
  };
  if (a.bufferView >= 0) {
    const unsigned char* element = bytes(a.bufferView).data() + a.byteOffset;
    const std::size_t stride = at(model_.bufferViews, a.bufferView).byteStride;
    for (std::size_t i = 0; i < count; ++i)
      copy(element + i * (stride == 0 ? size : stride), i);
  }
  if (!a.sparse.isSparse) return values;
  const auto& [indices, replacements] = std::tie(a.sparse.indices, a.sparse.values);
  const unsigned char* at_index = bytes(indices.bufferView).data() + indices.byteOffset;
  const unsigned char* at_value = bytes(replacements.bufferView).data() + replacements.byteOffset;
  std::uint64_t least = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.sparse.count); ++i) {
    const auto index = number_at<std::uint32_t>(at_index, indices.componentType, i);
    if (index < least || index >= a.count)
      fail(accessor, fmt::format("the sparse index {} is out of range or not larger than the one before", index));
    if (index >= count) break;
    copy(at_value + i * size, index);
    least = std::uint64_t{index} + 1;
  }
  return values;
}

std::vector<double> Values::numbers(int accessor, std::size_t most) const {
  return normalized(accessor, read<double>(accessor, most));
}

std::vector<double> Values::normalized(int accessor, std::vector<double> stored) const {
  const tinygltf::Accessor& a = at(model_.accessors, accessor);
  if (!a.normalized) return stored;
  for (double& value : stored)
    value = normalized_value(value, a.componentType);
  return stored;
}

std::vector<std::uint32_t> Values::indices(int accessor, std::size_t vertices) const {
  std::vector<std::uint32_t> values = read<std::uint32_t>(accessor, any_count);
  const std::size_t size = component_size(at(model_.accessors, accessor).componentType);
  const std::uint64_t restart = (std::uint64_t{1} << (8 * size)) - 1;
  const auto wrong = std::find_if(values.begin(), values.end(), [&](std::uint32_t v) { return v >= vertices; });
  if (wrong == values.end()) return values;
  const auto i = wrong - values.begin();
  if (*wrong == restart)
    fail(accessor, fmt::format("index {} is {}, a primitive restart, which glTF does not have", i, restart));
  fail(accessor, fmt::format("index {} names vertex {}, but there are only {}", i, *wrong, vertices));
}

void Values::check_bounds(int accessor, const Box& box) const {
  const tinygltf::Accessor& a = at(model_.accessors, accessor);
  for (std::size_t i = 0; i < 3 && !a.minValues.empty() && !a.maxValues.empty(); ++i) {
    const int axis = static_cast<int>(i);
    // The file states min and max of the stored values.
    const auto bound = [&](double value) { return a.normalized ? normalized_value(value, a.componentType) : value; };
    const double slack = 1e-6 * std::max(std::abs(box.low[axis]), std::abs(box.high[axis]));
    if (std::abs(bound(a.minValues[i]) - box.low[axis]) <= slack &&
        std::abs(bound(a.maxValues[i]) - box.high[axis]) <= slack)
      continue;
    log::warning(fmt::format("{}: accessor {}: its min and max do not match its positions", file_, accessor));
    break;
  }
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
