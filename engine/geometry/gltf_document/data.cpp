#include "geometry/gltf_document/data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint32_t>::max();
constexpr int i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126;

std::uint64_t component_size(std::uint64_t component) {
  switch (component) {
    case i8:
    case u8:
      return 1;
    case i16:
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

// The specification says that an accessor without a buffer view is all zeros, which these uses cannot be.
bool needs_data(Role role) {
  return role == Role::position || role == Role::indices || role == Role::bind_matrices || role == Role::rotation;
}

// The extension's object, under either of its names.
std::optional<Item> meshopt_of(const Item& item) {
  const auto extensions = item.item("extensions");
  if (!extensions) return std::nullopt;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (auto found = extensions->item(name)) return found;
  }
  return std::nullopt;
}

}  // namespace

void DataChecker::check_role(const Item& accessor, Role role, const std::string& type, std::uint64_t component) const {
  const bool whole = component == u8 || component == u16;
  const bool small = whole || component == i8 || component == i16;
  switch (role) {
    case Role::unused:
      return;
    case Role::position:
    case Role::displacement:
      if (type != "VEC3") accessor.fail(fmt::format("holds positions as {}; they must be VEC3", text::quoted(type)));
      if (component == f32 || (small && quantized_)) return;
      accessor.fail(
          fmt::format("holds positions of component type {}; they are 32-bit floats (5126) or, where "
                      "\"extensionsUsed\" has KHR_mesh_quantization, integers of 8 or 16 bits (5120 to 5123)",
                      component));
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
    case Role::place:
      if (type != "VEC3" || component != f32)
        accessor.fail("holds translations or scales of instances that are not VEC3 of floats (5126)");
      return;
    case Role::rotation:
      if (type != "VEC4" || !(component == f32 || component == i8 || component == i16))
        accessor.fail(
            "holds rotations of instances that are not VEC4 of floats, or of 8 or 16 bits (5126, 5120, 5122)");
      return;
  }
}

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
  buffer_count_ = stand_in("buffers", {{"byteLength", 1}, {"uri", "unused"}});
  buffers_.resize(buffer_count_);
  fallback_.resize(buffer_count_);
  view_checked_.resize(stand_in("bufferViews", {{"buffer", 0}, {"byteLength", 1}}));
  role_.resize(stand_in("accessors", {{"componentType", f32}, {"count", 1}, {"type", "SCALAR"}}));
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = root_.array(key);
    if (names != nullptr && std::find(names->begin(), names->end(), "KHR_mesh_quantization") != names->end())
      quantized_ = true;
  }
}

bool DataChecker::has_data(std::uint32_t accessor) const {
  return at("accessors", "accessor", accessor).has("bufferView");
}

DataChecker::Elements DataChecker::check_elements(const Item& accessor, Role role) const {
  const std::uint64_t count = accessor.needed_whole("count", 1, any);
  const std::uint64_t component = accessor.needed_whole("componentType", 5120, 5126);
  const std::string type = accessor.string("type").value_or("");
  const std::uint64_t size = component_size(component) * component_count(type);
  if (size == 0)
    accessor.fail(fmt::format("has the unknown type {} of component type {}", text::quoted(type), component));
  check_role(accessor, role, type, component);
  Json clean{{"componentType", component}, {"count", count}, {"type", type}};
  if (const auto normalized = accessor.json().find("normalized"); normalized != accessor.json().end()) {
    if (!normalized->is_boolean()) accessor.fail("\"normalized\" is neither true nor false");
    clean["normalized"] = *normalized;
  }
  return {count, component, size, std::move(clean)};
}

std::uint64_t DataChecker::check_compressed(std::uint32_t a, Role role) {
  Elements elements = check_elements(at("accessors", "accessor", a), role);
  // Another primitive may have its data uncompressed.
  if (role_[a] == Role::unused) (*clean_)["accessors"][a] = std::move(elements.clean);
  return elements.count;
}

std::uint64_t DataChecker::check(std::uint32_t a, Role role) {
  const Item accessor = at("accessors", "accessor", a);
  if (role_[a] == role) return accessor.needed_whole("count", 1, any);
  auto [count, component, element, clean] = check_elements(accessor, role);
  role_[a] = role;
  const auto view = accessor.index("bufferView", "buffer view", view_checked_.size());
  const std::uint64_t offset = accessor.whole("byteOffset", 0, any).value_or(0);
  if (view) {
    const BufferView found = check_view(*view);
    if (role == Role::indices && found.stride != 0) accessor.fail("holds indices in a buffer view with a byteStride");
    check_fit(accessor, found, offset, count, found.stride == 0 ? element : found.stride, element);
    if (offset % component_size(component) != 0) {
      log::warning(fmt::format("{}: {} starts at byte {}, not at a multiple of its components' size", root_.file(),
                               accessor.where(), offset));
    }
    clean["bufferView"] = *view;
    clean["byteOffset"] = offset;
  } else if (!accessor.has("sparse") && needs_data(role)) {
    accessor.fail("has no data: \"bufferView\" is missing");
  } else if (role == Role::indices || role == Role::weights || role == Role::bind_matrices || role == Role::place ||
             role == Role::rotation) {  // the vertices of a scene are counted elsewhere
    claim(accessor, count * element);
  }
  if (const auto sparse = accessor.item("sparse")) {
    clean["sparse"] = check_sparse(*sparse, count, element);
    if (!view && role == Role::indices) {
      clean["bufferView"] = clean["sparse"]["values"]["bufferView"];
      without_view_.push_back(a);
    }
  }
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
    const BufferView found = check_view(view);
    if (found.stride != 0) part.fail("are in a buffer view with a byteStride");
    check_fit(part, found, offset, count, size, size);
    return Json{{"bufferView", view}, {"byteOffset", offset}};
  };
  Json clean_indices = check_part(indices, component_size(component));
  clean_indices["componentType"] = component;
  return {{"count", count}, {"indices", std::move(clean_indices)}, {"values", check_part(values, element)}};
}

void DataChecker::check_fit(const Item& item, const BufferView& view, std::uint64_t offset, std::uint64_t count,
                            std::uint64_t stride, std::uint64_t element) {
  if (stride < element)
    item.fail(fmt::format("has elements of {} bytes, but its buffer view has a byteStride of {}", element, stride));
  if (offset > view.length || view.length - offset < element || count - 1 > (view.length - offset - element) / stride) {
    item.fail(fmt::format("does not fit its buffer view: {} elements, {} bytes apart, from byte {} on, in {} bytes",
                          count, stride, offset, view.length));
  }
}

DataChecker::BufferView DataChecker::check_view(std::uint32_t v) {
  const Item view = at("bufferViews", "buffer view", v);
  const std::uint32_t buffer = view.needed_index("buffer", "buffer", buffer_count_);
  const std::uint64_t offset = view.whole("byteOffset", 0, any).value_or(0);
  const std::uint64_t length = view.needed_whole("byteLength", 1, any);
  const auto stride = view.whole("byteStride", 4, 252);
  if (stride && *stride % 4 != 0) view.fail(fmt::format("\"byteStride\" is {}; it must be a multiple of 4", *stride));
  if (view_checked_[v]) return {length, stride.value_or(0)};
  view_checked_[v] = 1;
  Json& clean = (*clean_)["bufferViews"][v];
  if (const auto packed = meshopt_of(view)) {
    // Its own buffer is a fallback for readers that do not know the extension, and need not exist.
    fallback_[buffer] = 1;
    check_packed(*packed, v, length, stride.value_or(0));
  } else {
    const std::uint64_t available = check_buffer(buffer);
    if (offset > available || length > available - offset) {
      view.fail(
          fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", length, offset, available));
    }
    clean = {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
  }
  if (stride) clean["byteStride"] = *stride;
  return {length, stride.value_or(0)};
}

void DataChecker::check_stream(std::uint32_t view) {
  claim(at("bufferViews", "buffer view", view), check_view(view).length);
}

// Adds a new buffer for the unpacked data.
void DataChecker::check_packed(const Item& item, std::uint32_t v, std::uint64_t length, std::uint64_t stride) {
  MeshoptBufferView packed;
  packed.buffer = item.needed_index("buffer", "buffer", buffer_count_);
  packed.offset = item.whole("byteOffset", 0, any).value_or(0);
  packed.length = item.needed_whole("byteLength", 1, any);
  packed.stride = item.needed_whole("byteStride", 1, 256);
  packed.count = item.needed_whole("count", 1, any);
  const std::string mode = item.string("mode").value_or(""), filter = item.string("filter").value_or("NONE");
  const auto choose = [&](const char* key, const std::string& name, const auto& known) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      item.fail(fmt::format("\"{}\" is {}; palpa knows {}", key, text::quoted(name), fmt::join(known, ", ")));
    return found - known.begin();
  };
  static constexpr std::array<std::string_view, 3> modes{"ATTRIBUTES", "TRIANGLES", "INDICES"};
  static constexpr std::array<std::string_view, 4> filters{"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  packed.mode = static_cast<MeshoptMode>(choose("mode", mode, modes));
  packed.filter = static_cast<MeshoptFilter>(choose("filter", filter, filters));
  if (const auto fault = meshopt_fault(packed)) item.fail(*fault);
  if (packed.stride * packed.count != length) {
    item.fail(fmt::format("unpacks to {} elements of {} bytes, but the buffer view has {} bytes", packed.count,
                          packed.stride, length));
  }
  if (stride != 0 && stride != packed.stride)
    item.fail(fmt::format("has a byteStride of {}, but the buffer view has one of {}", packed.stride, stride));
  const std::uint64_t available = check_buffer(packed.buffer);
  if (packed.offset > available || packed.length > available - packed.offset) {
    item.fail(fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", packed.length,
                          packed.offset, available));
  }
  claim(item, length);
  const std::size_t b = buffers_.size();
  buffers_.push_back({length, "", packed});
  (*clean_)["buffers"].push_back({{"byteLength", length}, {"uri", fmt::format("buffer {}", b)}});
  (*clean_)["bufferViews"][v] = {{"buffer", b}, {"byteOffset", 0}, {"byteLength", length}};
}

void DataChecker::claim(const Item& item, std::uint64_t bytes) {
  total_ += std::min(bytes, most_buffer_bytes + 1);
  if (total_ > most_buffer_bytes) {
    item.fail(fmt::format("brings the buffers to more than {} bytes, packed and unpacked; palpa reads no more",
                          most_buffer_bytes));
  }
}

std::uint64_t DataChecker::check_buffer(std::uint32_t b) {
  BufferSource& source = buffers_[b];
  if (source.length != 0) return source.length;
  const Item buffer = at("buffers", "buffer", b);
  const std::uint64_t length = buffer.needed_whole("byteLength", 1, any);
  auto uri = buffer.string("uri");
  if (uri) uri = parsed_.whole(*uri);
  if (!uri) {
    if (b != 0 || !container_.bin) buffer.fail("has no \"uri\", and the file has no BIN chunk for it");
    if (length > container_.bin->size) {
      buffer.fail(fmt::format("\"byteLength\" is {}, but the BIN chunk has {} bytes", length, container_.bin->size));
    }
  } else if (const auto fault = uri_fault(*uri)) {
    buffer.fail(*fault);
  }
  if (length > most_buffer_bytes) {
    buffer.fail(
        fmt::format("\"byteLength\" is {}; palpa reads at most {} bytes of buffers", length, most_buffer_bytes));
  }
  claim(buffer, length);
  source = {length, std::move(uri).value_or("")};
  (*clean_)["buffers"][b] = {{"byteLength", length}, {"uri", fmt::format("buffer {}", b)}};
  return length;
}

void DataChecker::check_rest() {
  for (std::uint32_t i = 0; i < view_checked_.size(); ++i)
    check_view(i);
  for (std::uint32_t i = 0; i < buffer_count_; ++i) {
    if (!fallback_[i]) check_buffer(i);
  }
  for (std::uint32_t i = 0; i < role_.size(); ++i) {
    if (role_[i] == Role::unused) {
      role_[i] = Role::position;  // any role other than the requested one
      check(i, Role::unused);
    }
  }
}

}  // namespace palpa::geometry::gltf
