#include "geometry/gltf_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf_buffers.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint32_t>::max();
constexpr int u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126;

std::uint64_t component_size(std::uint64_t component) {
  switch (component) {
    case 5120:
    case u8:
      return 1;
    case 5122:
    case u16:
      return 2;
    case u32:
    case f32:
      return 4;
    default:
      return 0;
  }
}

std::uint64_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  return 0;
}

void check_role(const Item& accessor, Role role, const std::string& type, std::uint64_t component) {
  const bool whole = component == u8 || component == u16;
  switch (role) {
    case Role::unused:
      return;
    case Role::position:
    case Role::displacement:
      if (type != "VEC3") accessor.fail(fmt::format("holds positions as {}; they are VEC3", text::quoted(type)));
      if (component != f32) {
        accessor.fail(fmt::format(
            "holds positions of component type {}; without the extension KHR_mesh_quantization, which palpa "
            "does not support, they are 32-bit floats (5126)",
            component));
      }
      return;
    case Role::indices:
      if (type != "SCALAR" || !(whole || component == u32)) {
        accessor.fail("holds indices that are not scalar unsigned integers of 8, 16 or 32 bits (5121, 5123, 5125)");
      }
      return;
    case Role::joints:
      if (type != "VEC4" || !whole) accessor.fail("holds joints that are not VEC4 of 8 or 16 bits (5121, 5123)");
      return;
    case Role::weights:
      if (type != "VEC4" || !(component == f32 || whole)) {
        accessor.fail("holds weights that are not VEC4 of floats or of 8 or 16 bits (5126, 5121, 5123)");
      }
      return;
    case Role::bind_matrices:
      if (type != "MAT4" || component != f32)
        accessor.fail("holds inverse bind matrices that are not MAT4 of floats (5126)");
      return;
  }
}

}  // namespace

DataChecker::DataChecker(const Item& root, const Parsed& parsed, const Container& container)
    : root_(root), parsed_(parsed), container_(container) {}

Item DataChecker::at(const char* key, const char* name, std::size_t index) const {
  return {root_.file(), (*root_.array(key))[index], fmt::format("{} {}", name, index)};
}

void DataChecker::start(Json& clean) {
  clean_ = &clean;
  const auto stand_in = [&](const char* key, const Json& value) {
    const Json* items = root_.array(key);
    if (items != nullptr && !items->empty()) clean[key] = Json::array_t(items->size(), value);
    return items == nullptr ? 0 : items->size();
  };
  buffers_.resize(stand_in("buffers", {{"byteLength", 1}, {"uri", "unused"}}));
  view_checked_.resize(stand_in("bufferViews", {{"buffer", 0}, {"byteLength", 1}}));
  role_.resize(stand_in("accessors", {{"componentType", f32}, {"count", 1}, {"type", "SCALAR"}}));
}

bool DataChecker::has_data(std::uint32_t accessor) const {
  return at("accessors", "accessor", accessor).has("bufferView");
}

std::uint64_t DataChecker::check(std::uint32_t a, Role role) {
  const Item accessor = at("accessors", "accessor", a);
  const std::uint64_t count = accessor.needed_whole("count", 1, any);
  if (role_[a] == role) return count;
  role_[a] = role;
  const std::uint64_t component = accessor.needed_whole("componentType", 5120, 5126);
  const std::string type = accessor.string("type").value_or("");
  const std::uint64_t element = component_size(component) * component_count(type);
  if (element == 0)
    accessor.fail(fmt::format("has the unknown type {} of component type {}", text::quoted(type), component));
  check_role(accessor, role, type, component);
  Json clean{{"componentType", component}, {"count", count}, {"type", type}};
  const auto view = accessor.index("bufferView", "buffer view", view_checked_.size());
  const std::uint64_t offset = accessor.whole("byteOffset", 0, any).value_or(0);
  if (view) {
    const View found = check_view(*view);
    if (role == Role::indices && found.stride != 0) accessor.fail("holds indices in a buffer view with a byteStride");
    check_fit(accessor, found, offset, count, found.stride == 0 ? element : found.stride, element);
    if (offset % component_size(component) != 0) {
      log::warning(fmt::format("{}: {} starts at byte {}, not at a multiple of its components' size", root_.file(),
                               accessor.where(), offset));
    }
    clean["bufferView"] = *view;
    clean["byteOffset"] = offset;
  } else if (role != Role::displacement && role != Role::unused &&
             (role != Role::position || !accessor.has("sparse"))) {
    // All zeros, says the specification; nothing but displacements means anything by that.
    accessor.fail("has no data: \"bufferView\" is missing");
  }
  if (const auto sparse = accessor.item("sparse")) clean["sparse"] = check_sparse(*sparse, count, element);
  if (role == Role::position) {
    for (const char* key : {"min", "max"}) {
      if (const auto bound = accessor.numbers(key, 3)) clean[key] = *bound;
    }
  }
  (*clean_)["accessors"][a] = std::move(clean);
  return count;
}

Json DataChecker::check_sparse(const Item& sparse, std::uint64_t accessor_count, std::uint64_t element) {
  const std::uint64_t count = sparse.needed_whole("count", 1, accessor_count);
  const Item indices = sparse.needed_item("indices"), values = sparse.needed_item("values");
  const std::uint64_t component = indices.needed_whole("componentType", 5120, 5126);
  if (component != u8 && component != u16 && component != u32)
    indices.fail("are not unsigned integers of 8, 16 or 32 bits");
  const auto check_part = [&](const Item& part, std::uint64_t size) {
    const std::uint32_t view = part.needed_index("bufferView", "buffer view", view_checked_.size());
    const std::uint64_t offset = part.whole("byteOffset", 0, any).value_or(0);
    const View found = check_view(view);
    if (found.stride != 0) part.fail("are in a buffer view with a byteStride");
    check_fit(part, found, offset, count, size, size);
    return Json{{"bufferView", view}, {"byteOffset", offset}};
  };
  Json clean_indices = check_part(indices, component_size(component));
  clean_indices["componentType"] = component;
  return {{"count", count}, {"indices", std::move(clean_indices)}, {"values", check_part(values, element)}};
}

void DataChecker::check_fit(const Item& item, const View& view, std::uint64_t offset, std::uint64_t count,
                            std::uint64_t stride, std::uint64_t element) {
  if (stride < element)
    item.fail(fmt::format("has elements of {} bytes, but its buffer view a byteStride of {}", element, stride));
  if (offset > view.length || view.length - offset < element || count - 1 > (view.length - offset - element) / stride) {
    item.fail(fmt::format("does not fit its buffer view: {} elements, {} bytes apart, from byte {} on, in {} bytes",
                          count, stride, offset, view.length));
  }
}

DataChecker::View DataChecker::check_view(std::uint32_t v) {
  const Item view = at("bufferViews", "buffer view", v);
  const std::uint32_t buffer = view.needed_index("buffer", "buffer", buffers_.size());
  const std::uint64_t offset = view.whole("byteOffset", 0, any).value_or(0);
  const std::uint64_t length = view.needed_whole("byteLength", 1, any);
  const auto stride = view.whole("byteStride", 4, 252);
  if (stride && *stride % 4 != 0) view.fail(fmt::format("\"byteStride\" is {}; it must be a multiple of 4", *stride));
  if (view_checked_[v]) return {length, stride.value_or(0)};
  view_checked_[v] = 1;
  const bool compressed =
      view.has_extension("EXT_meshopt_compression") || view.has_extension("KHR_meshopt_compression");
  const Item source = at("buffers", "buffer", buffer);
  if (compressed && !source.has("uri") && !(buffer == 0 && container_.bin)) {
    view.fail("is stored with the extension EXT_meshopt_compression only, which palpa does not support");
  }
  const std::uint64_t available = check_buffer(buffer);
  if (offset > available || length > available - offset) {
    view.fail(fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", length, offset, available));
  }
  Json clean{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
  if (stride) clean["byteStride"] = *stride;
  (*clean_)["bufferViews"][v] = std::move(clean);
  return {length, stride.value_or(0)};
}

std::uint64_t DataChecker::check_buffer(std::uint32_t b) {
  BufferSource& source = buffers_[b];
  if (source.length != 0) return source.length;
  const Item buffer = at("buffers", "buffer", b);
  const std::uint64_t length = buffer.needed_whole("byteLength", 1, any);
  auto uri = buffer.string("uri");
  if (uri) uri = parsed_.whole(*uri);
  if (!uri) {
    if (b != 0 || !container_.bin) buffer.fail("has no \"uri\", and there is no BIN chunk that could be it");
    if (length > container_.bin->size) {
      buffer.fail(fmt::format("\"byteLength\" is {}, but the BIN chunk has {} bytes", length, container_.bin->size));
    }
  } else if (const auto fault = uri_fault(*uri)) {
    buffer.fail(*fault);
  }
  total_ += std::min(length, most_buffer_bytes + 1);
  if (total_ > most_buffer_bytes) {
    buffer.fail(
        fmt::format("\"byteLength\" is {}; palpa reads at most {} bytes of buffers", length, most_buffer_bytes));
  }
  source = {length, std::move(uri).value_or("")};
  (*clean_)["buffers"][b] = {{"byteLength", length}, {"uri", fmt::format("buffer {}", b)}};
  return length;
}

void DataChecker::check_rest() {
  for (std::uint32_t i = 0; i < buffers_.size(); ++i)
    check_buffer(i);
  for (std::uint32_t i = 0; i < view_checked_.size(); ++i)
    check_view(i);
  for (std::uint32_t i = 0; i < role_.size(); ++i) {
    if (role_[i] == Role::unused) {
      role_[i] = Role::position;  // any role but the one asked for
      check(i, Role::unused);
    }
  }
}

}  // namespace palpa::geometry::gltf
