#include "geometry/gltf/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.hpp"
#include "geometry/gltf_document/buffers.hpp"

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
T number_at(const unsigned char* element, Component component, std::size_t i) {
  switch (component) {
    case Component::i8:
      return load<T, std::int8_t>(element, i);
    case Component::u8:
      return load<T, std::uint8_t>(element, i);
    case Component::i16:
      return load<T, std::int16_t>(element, i);
    case Component::u16:
      return load<T, std::uint16_t>(element, i);
    case Component::u32:
      return load<T, std::uint32_t>(element, i);
    case Component::f32:
      break;
  }
  return load<T, float>(element, i);
}

}  // namespace

Values::Values(const InputFile& file, const std::optional<BinChunk>& bin, const Document& document)
    : file_(file.name()), document_(document), buffers_(load_buffers(file, bin, document.buffers)) {}

void Values::fail(std::uint32_t accessor, const std::string& fault) const {
  throw bad_input(file_, fmt::format("accessor {}: {}", accessor, fault));
}

std::span<const unsigned char> Values::bytes(const View& view) const {
  return std::span(buffers_[view.buffer]).subspan(view.offset, view.length);
}

template <typename T>
std::vector<T> Values::read(std::uint32_t accessor, std::size_t most) const {
  const Accessor& a = document_.accessors[accessor];
  const std::size_t count = std::min<std::size_t>(a.count, most);
  std::vector<T> values(count * a.width);
  const auto copy = [&](const unsigned char* element, std::size_t target) {
    for (std::size_t i = 0; i < a.width; ++i)
      values[target * a.width + i] = number_at<T>(element, a.component, i);
  };
  const unsigned char* element = a.data ? bytes(*a.data).data() : nullptr;
  for (std::size_t i = 0; a.data && i < count; ++i)
    copy(element + i * a.data->stride, i);
  if (!a.sparse) return values;
  const Sparse& sparse = *a.sparse;
  const unsigned char* at = bytes(sparse.indices).data();
  element = bytes(sparse.values).data();
  std::uint64_t least = 0;
  for (std::size_t i = 0; i < sparse.count; ++i) {
    const auto index = number_at<std::uint32_t>(at + i * sparse.indices.stride, sparse.component, 0);
    if (index < least || index >= a.count)
      fail(accessor, fmt::format("the sparse index {} is out of range or not larger than the one before", index));
    if (index >= count) break;
    copy(element + i * sparse.values.stride, index);
    least = std::uint64_t{index} + 1;
  }
  return values;
}

std::vector<double> Values::numbers(std::uint32_t accessor, std::size_t most) const {
  std::vector<double> values = read<double>(accessor, most);
  const Accessor& a = document_.accessors[accessor];
  if (a.normalized) {
    for (double& value : values)
      value = normalized_value(value, a.component);
  }
  return values;
}

std::vector<std::uint32_t> Values::indices(std::uint32_t accessor, std::size_t vertices) const {
  std::vector<std::uint32_t> values = read<std::uint32_t>(accessor, any_count);
  const std::uint64_t restart = (std::uint64_t{1} << (8 * size_of(document_.accessors[accessor].component))) - 1;
  const auto wrong = std::find_if(values.begin(), values.end(), [&](std::uint32_t v) { return v >= vertices; });
  if (wrong == values.end()) return values;
  const auto i = wrong - values.begin();
  if (*wrong == restart)
    fail(accessor, fmt::format("index {} is {}, a primitive restart, which glTF does not have", i, restart));
  fail(accessor, fmt::format("index {} names vertex {}, but there are only {}", i, *wrong, vertices));
}

double normalized_value(double integer, Component component) {
  switch (component) {
    case Component::i8:
      return std::max(integer / 127.0, -1.0);
    case Component::u8:
      return integer / 255.0;
    case Component::i16:
      return std::max(integer / 32767.0, -1.0);
    case Component::u16:
      return integer / 65535.0;
    default:
      return integer;
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
