#include "geometry/gltf_document/data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126;

// In bytes; 0 for numbers that are no component type.
std::uint64_t size_of(std::uint64_t component) {
  if (component == i8 || component == u8) return 1;
  if (component == i16 || component == u16) return 2;
  return component == u32 || component == f32 ? 4 : 0;
}

std::uint64_t width_of(const std::string& type) {
  static constexpr std::array<std::pair<std::string_view, std::uint64_t>, 7> widths{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const auto found = std::find_if(widths.begin(), widths.end(), [&](const auto& known) { return known.first == type; });
  return found == widths.end() ? 0 : found->second;
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

// `count` elements from `offset` on must fit into a view of `length` bytes.
void check_elements_fit(const Item& item, std::uint64_t length, std::uint64_t offset, std::uint64_t count,
                        std::uint64_t stride, std::uint64_t element) {
  if (stride < element)
    item.fail(fmt::format("has elements of {} bytes, but its buffer view has a byteStride of {}", element, stride));
  if (offset > length || length - offset < element || count - 1 > (length - offset - element) / stride) {
    item.fail(fmt::format("does not fit its buffer view: {} elements, {} bytes apart, from byte {} on, in {} bytes",
                          count, stride, offset, length));
  }
}

void check_bytes_fit(const Item& item, std::uint64_t offset, std::uint64_t length, std::uint64_t available) {
  if (offset > available || length > available - offset) {
    item.fail(fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", length, offset, available));
  }
}

}  // namespace

void DataChecker::check_role(const Item& accessor, Role role, const std::string& type, std::uint64_t component) const {
  const auto require = [&](const char* right_type, std::initializer_list<std::uint64_t> right, const char* fault) {
    if (type != right_type || std::find(right.begin(), right.end(), component) == right.end()) accessor.fail(fault);
  };
  switch (role) {
    case Role::unused:
      return;
    case Role::position:
    case Role::displacement:
      if (type != "VEC3") accessor.fail(fmt::format("holds positions as {}; they must be VEC3", text::quoted(type)));
      if (component == f32 || (quantized_ && component != u32)) return;
      accessor.fail(
          fmt::format("holds positions of component type {}; they are 32-bit floats (5126) or, where "
                      "\"extensionsUsed\" has KHR_mesh_quantization, integers of 8 or 16 bits (5120 to 5123)",
                      component));
    case Role::indices:
      return require("SCALAR", {u8, u16, u32},
                     "holds indices that are not scalar unsigned integers of 8, 16 or 32 bits (5121, 5123, 5125)");
    case Role::joints:
      return require("VEC4", {u8, u16}, "holds joints that are not VEC4 of 8 or 16 bits (5121, 5123)");
    case Role::weights:
      return require("VEC4", {f32, u8, u16},
                     "holds weights that are not VEC4 of floats or of 8 or 16 bits (5126, 5121, 5123)");
    case Role::bind_matrices:
      return require("MAT4", {f32}, "holds inverse bind matrices that are not MAT4 of floats (5126)");
    case Role::place:
      return require("VEC3", {f32}, "holds translations or scales of instances that are not VEC3 of floats (5126)");
    case Role::rotation:
      return require("VEC4", {f32, i8, i16},
                     "holds rotations of instances that are not VEC4 of floats, or of 8 or 16 bits (5126, 5120, 5122)");
  }
}

DataChecker::DataChecker(const Item& root, const Parsed& parsed, const Container& container, Document& document)
    : root_(root), parsed_(parsed), container_(container), buffers_(document.buffers) {
  buffers_.resize(root.size("buffers"));
  fallback_.resize(root.size("buffers"));
  role_.resize(root.size("accessors"));
  count_.resize(root.size("accessors"));
  views_.resize(root.size("bufferViews"));
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = root_.array(key);
    if (names != nullptr && std::find(names->begin(), names->end(), "KHR_mesh_quantization") != names->end())
      quantized_ = true;
  }
}

std::optional<std::uint32_t> DataChecker::named(const Item& item, const char* key) const {
  return item.index(key, "accessor", role_.size());
}

bool DataChecker::has_data(std::uint32_t accessor) const {
  return at("accessors", "accessor", accessor).has("bufferView");
}

DataChecker::Elements DataChecker::check_elements(const Item& accessor, Role role) const {
  const std::uint64_t count = accessor.needed_whole("count", 1, any);
  const std::uint64_t component = accessor.needed_whole("componentType", 5120, 5126);
  const std::string type = accessor.string("type").value_or("");
  const std::uint64_t size = size_of(component) * width_of(type);
  if (size == 0)
    accessor.fail(fmt::format("has the unknown type {} of component type {}", text::quoted(type), component));
  check_role(accessor, role, type, component);
  accessor.boolean("normalized");
  return {count, size_of(component), size};
}

std::uint64_t DataChecker::check_compressed(std::uint32_t a, Role role) const {
  return check_elements(at("accessors", "accessor", a), role).count;
}

std::uint64_t DataChecker::check(std::uint32_t a, Role role) {
  if (role_[a] == role) return count_[a];
  const Item accessor = at("accessors", "accessor", a);
  const Elements elements = check_elements(accessor, role);
  role_[a] = role;
  count_[a] = elements.count;
  const auto view = accessor.index("bufferView", "buffer view", views_.size());
  const std::uint64_t offset = accessor.whole("byteOffset", 0, any).value_or(0);
  if (view) {
    const auto [length, stride] = check_view(*view);
    if (role == Role::indices && stride != 0) accessor.fail("holds indices in a buffer view with a byteStride");
    check_elements_fit(accessor, length, offset, elements.count, stride == 0 ? elements.size : stride, elements.size);
    if (offset % elements.component_size != 0)
      accessor.warn(fmt::format("starts at byte {}, not at a multiple of its components' size", offset));
  } else if (!accessor.has("sparse") && needs_data(role)) {
    accessor.fail("has no data: \"bufferView\" is missing");
  } else if (role != Role::unused && role != Role::position && role != Role::displacement && role != Role::joints) {
    claim(accessor, elements.count * elements.size);  // the vertices of a scene are counted elsewhere
  }
  if (const auto sparse = accessor.item("sparse")) check_sparse(*sparse, elements);
  if (role == Role::position) {
    accessor.numbers("min", 3);
    accessor.numbers("max", 3);
  }
  return elements.count;
}

void DataChecker::check_sparse(const Item& sparse, const Elements& elements) {
  const std::uint64_t count = sparse.needed_whole("count", 1, elements.count);
  const Item indices = sparse.needed_item("indices"), values = sparse.needed_item("values");
  const std::uint64_t component = indices.needed_whole("componentType", 5120, 5126);
  if (component != u8 && component != u16 && component != u32)
    indices.fail("are not unsigned integers of 8, 16 or 32 bits");
  const auto check_part = [&](const Item& part, std::uint64_t size) {
    const std::uint32_t view = part.needed_index("bufferView", "buffer view", views_.size());
    const std::uint64_t offset = part.whole("byteOffset", 0, any).value_or(0);
    const auto [length, stride] = check_view(view);
    if (stride != 0) part.fail("are in a buffer view with a byteStride");
    check_elements_fit(part, length, offset, count, size, size);
  };
  check_part(indices, size_of(component));
  check_part(values, elements.size);
}

DataChecker::View DataChecker::check_view(std::uint32_t v) {
  if (views_[v]) return *views_[v];
  const Item item = at("bufferViews", "buffer view", v);
  const std::uint32_t buffer = item.needed_index("buffer", "buffer", fallback_.size());
  const std::uint64_t offset = item.whole("byteOffset", 0, any).value_or(0);
  const View view{item.needed_whole("byteLength", 1, any), item.whole("byteStride", 4, 252).value_or(0)};
  if (view.stride % 4 != 0) item.fail(fmt::format("\"byteStride\" is {}; it must be a multiple of 4", view.stride));
  if (const auto packed = meshopt_of(item)) {
    // Its own buffer is a fallback for readers that do not know the extension, and need not exist.
    fallback_[buffer] = 1;
    check_packed(item, *packed, view);
  } else {
    check_bytes_fit(item, offset, view.length, check_buffer(buffer));
  }
  views_[v] = view;
  return view;
}

Item DataChecker::check_stream(const Item& extension) {
  const std::uint32_t view = extension.needed_index("bufferView", "buffer view", views_.size());
  claim(at("bufferViews", "buffer view", view), check_view(view).length);
  Item attributes = extension.needed_item("attributes");
  for (const auto& [name, id] : attributes.json().items())
    attributes.needed_whole(name.c_str(), 0, any);
  if (!attributes.has("POSITION")) attributes.fail("\"POSITION\" is missing");
  return attributes;
}

// Adds a new buffer for the unpacked data, which the copy's view shows.
void DataChecker::check_packed(const Item& view, const Item& item, const View& unpacked) {
  MeshoptBufferView packed;
  packed.buffer = item.needed_index("buffer", "buffer", fallback_.size());
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
  if (packed.stride * packed.count != unpacked.length) {
    item.fail(fmt::format("unpacks to {} elements of {} bytes, but the buffer view has {} bytes", packed.count,
                          packed.stride, unpacked.length));
  }
  if (unpacked.stride != 0 && unpacked.stride != packed.stride)
    item.fail(fmt::format("has a byteStride of {}, but the buffer view has one of {}", packed.stride, unpacked.stride));
  check_bytes_fit(item, packed.offset, packed.length, check_buffer(packed.buffer));
  claim(item, unpacked.length);
  view.write("buffer", buffers_.size());
  view.write("byteOffset", 0);
  buffers_.push_back({unpacked.length, {}, packed});
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
  source = {length, std::move(uri).value_or(""), std::nullopt};
  return length;
}

void DataChecker::check_rest() {
  for (std::uint32_t i = 0; i < views_.size(); ++i)
    check_view(i);
  for (std::uint32_t i = 0; i < fallback_.size(); ++i) {
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
