#include "geometry/gltf/values.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "base/error.hpp"

namespace palpa::geometry::gltf {
namespace {

std::size_t component_size(int component) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component)));
}

}  // namespace

void Values::fail(const std::string& fault) const {
  throw bad_input(file_, fault);
}

void Values::fail_sparse(std::size_t accessor, std::uint64_t index) const {
  fail(fmt::format("accessor {}: the sparse index {} is out of range or not larger than the one before", accessor,
                   index));
}

std::vector<double> Values::numbers(std::size_t accessor, std::size_t width) const {
  std::uint64_t fault = 0;
  auto values = read_numbers(column(accessor, width), width, sparse(accessor, width), fault);
  if (!values) fail_sparse(accessor, fault);
  return *std::move(values);
}

std::vector<std::uint32_t> Values::indices(std::size_t accessor, std::size_t vertices) const {
  std::uint64_t fault = 0;
  auto read = read_unsigned(column(accessor, 1), 1, sparse(accessor, 1), fault);
  if (!read) fail_sparse(accessor, fault);
  std::vector<std::uint32_t> values = *std::move(read);
  const std::size_t size = component_size(model_.accessors[accessor].componentType);
  const std::uint32_t restart = size == 4 ? 0xffffffffU : (1U << (8 * size)) - 1;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < vertices) continue;
    if (values[i] == restart) {
      fail(fmt::format("accessor {}: index {} is {}, a primitive restart, which glTF does not have", accessor, i,
                       restart));
    }
    fail(fmt::format("accessor {}: index {} names vertex {}, but there are only {}", accessor, i, values[i], vertices));
  }
  return values;
}

Column Values::column(int view_index, std::size_t offset, std::size_t count, std::size_t element, int component) const {
  if (view_index < 0) return {{}, count, element, component};
  const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
  const std::span<const unsigned char> bytes(model_.buffers[static_cast<std::size_t>(view.buffer)].data);
  return {bytes.subspan(view.byteOffset, view.byteLength).subspan(offset), count,
          view.byteStride == 0 ? element : view.byteStride, component};
}

Column Values::column(std::size_t accessor, std::size_t width) const {
  const tinygltf::Accessor& a = model_.accessors[accessor];
  Column result = column(a.bufferView, a.byteOffset, a.count, width * component_size(a.componentType), a.componentType);
  result.normalized = a.normalized;
  return result;
}

std::optional<Sparse> Values::sparse(std::size_t accessor, std::size_t width) const {
  const tinygltf::Accessor& a = model_.accessors[accessor];
  if (!a.sparse.isSparse) return std::nullopt;
  const auto count = static_cast<std::size_t>(a.sparse.count);
  const auto& indices = a.sparse.indices;
  const auto& values = a.sparse.values;
  return Sparse{column(indices.bufferView, static_cast<std::size_t>(indices.byteOffset), count,
                       component_size(indices.componentType), indices.componentType),
                column(values.bufferView, static_cast<std::size_t>(values.byteOffset), count,
                       width * component_size(a.componentType), a.componentType)};
}

}  // namespace palpa::geometry::gltf
