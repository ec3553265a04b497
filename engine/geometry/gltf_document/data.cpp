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

// The part of the view from `offset` on, which must have room for `count` elements.
View elements_in(const Item& item, const View& view, std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                 std::uint64_t element) {
  if (stride < element)
    item.fail(fmt::format("has elements of {} bytes, but its buffer view has a byteStride of {}", element, stride));
  if (offset > view.length || view.length - offset < element || count - 1 > (view.length - offset - element) / stride) {
    item.fail(fmt::format("does not fit its buffer view: {} elements, {} bytes apart, from byte {} on, in {} bytes",
                          count, stride, offset, view.length));
  }
  return {view.buffer, view.offset + offset, view.length - offset, stride};
}

void check_fit(const Item& item, const View& view, std::uint64_t available) {
  if (view.offset > available || view.length > available - view.offset) {
    item.fail(fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", view.length, view.offset,
                          available));
  }
}

}  // namespace

std::uint64_t size_of(Component component) {
  switch (component) {
    case Component::i8:
    case Component::u8:
      return 1;
    case Component::i16:
    case Component::u16:
      return 2;
    case Component::u32:
    case Component::f32:
      return 4;
  }
  return 0;
}

void DataReader::check_role(const Item& accessor, Role role, const std::string& type, Component component) const {
  using enum Component;
  const auto require = [&](const char* right_type, std::initializer_list<Component> right, const char* fault) {
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
                      static_cast<int>(component)));
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

DataReader::DataReader(const Item& root, const Parsed& parsed, const Container& container, Document& document)
    : root_(root), parsed_(parsed), container_(container), document_(document) {
  document_.accessors.resize(root.size("accessors"));
  document_.buffers.resize(root.size("buffers"));
  role_.resize(root.size("accessors"));
  views_.resize(root.size("bufferViews"));
  fallback_.resize(root.size("buffers"));
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = root_.array(key);
    if (names != nullptr && std::find(names->begin(), names->end(), "KHR_mesh_quantization") != names->end())
      quantized_ = true;
  }
}

std::optional<std::uint32_t> DataReader::named(const Item& item, const char* key) const {
  return item.index(key, "accessor", role_.size());
}

bool DataReader::has_data(std::uint32_t accessor) const {
  return at("accessors", "accessor", accessor).has("bufferView");
}

Accessor DataReader::read_elements(const Item& accessor, Role role) const {
  Accessor read;
  read.count = accessor.needed_whole("count", 1, any);
  read.component = static_cast<Component>(accessor.needed_whole("componentType", 5120, 5126));
  const std::string type = accessor.string("type").value_or("");
  read.width = width_of(type);
  if (size_of(read.component) * read.width == 0) {
    accessor.fail(fmt::format("has the unknown type {} of component type {}", text::quoted(type),
                              static_cast<int>(read.component)));
  }
  check_role(accessor, role, type, read.component);
  if (const auto normalized = accessor.json().find("normalized"); normalized != accessor.json().end()) {
    if (!normalized->is_boolean()) accessor.fail("\"normalized\" is neither true nor false");
    read.normalized = normalized->get<bool>();
  }
  return read;
}

std::uint64_t DataReader::read_compressed(std::uint32_t a, Role role) {
  Accessor read = read_elements(at("accessors", "accessor", a), role);
  const std::uint64_t count = read.count;
  // Another primitive may have its data uncompressed.
  if (role_[a] == Role::unused) document_.accessors[a] = std::move(read);
  return count;
}

std::uint64_t DataReader::read(std::uint32_t a, Role role) {
  if (role_[a] == role) return document_.accessors[a].count;
  const Item accessor = at("accessors", "accessor", a);
  Accessor read = read_elements(accessor, role);
  role_[a] = role;
  const std::uint64_t component = size_of(read.component), element = read.width * component;
  const auto view = accessor.index("bufferView", "buffer view", views_.size());
  const std::uint64_t offset = accessor.whole("byteOffset", 0, any).value_or(0);
  if (view) {
    const View& found = read_view(*view);
    if (role == Role::indices && found.stride != 0) accessor.fail("holds indices in a buffer view with a byteStride");
    read.data = elements_in(accessor, found, offset, read.count, found.stride == 0 ? element : found.stride, element);
    if (offset % component != 0) {
      log::warning(fmt::format("{}: {} starts at byte {}, not at a multiple of its components' size", root_.file(),
                               accessor.where(), offset));
    }
  } else if (!accessor.has("sparse") && needs_data(role)) {
    accessor.fail("has no data: \"bufferView\" is missing");
  } else if (role != Role::unused && role != Role::position && role != Role::displacement && role != Role::joints) {
    claim(accessor, read.count * element);  // the vertices of a scene are counted elsewhere
  }
  if (const auto sparse = accessor.item("sparse")) read.sparse = read_sparse(*sparse, read);
  if (role == Role::position) {
    read.min = accessor.numbers("min", 3).value_or(std::vector<double>{});
    read.max = accessor.numbers("max", 3).value_or(std::vector<double>{});
  }
  document_.accessors[a] = std::move(read);
  return document_.accessors[a].count;
}

Sparse DataReader::read_sparse(const Item& sparse, const Accessor& accessor) {
  Sparse read;
  read.count = sparse.needed_whole("count", 1, accessor.count);
  const Item indices = sparse.needed_item("indices"), values = sparse.needed_item("values");
  read.component = static_cast<Component>(indices.needed_whole("componentType", 5120, 5126));
  if (read.component != Component::u8 && read.component != Component::u16 && read.component != Component::u32)
    indices.fail("are not unsigned integers of 8, 16 or 32 bits");
  const auto read_part = [&](const Item& part, std::uint64_t size) {
    const std::uint32_t view = part.needed_index("bufferView", "buffer view", views_.size());
    const std::uint64_t offset = part.whole("byteOffset", 0, any).value_or(0);
    const View& found = read_view(view);
    if (found.stride != 0) part.fail("are in a buffer view with a byteStride");
    return elements_in(part, found, offset, read.count, size, size);
  };
  read.indices = read_part(indices, size_of(read.component));
  read.values = read_part(values, accessor.width * size_of(accessor.component));
  return read;
}

const View& DataReader::read_view(std::uint32_t v) {
  if (views_[v]) return *views_[v];
  const Item item = at("bufferViews", "buffer view", v);
  View view;
  view.buffer = item.needed_index("buffer", "buffer", fallback_.size());
  view.offset = item.whole("byteOffset", 0, any).value_or(0);
  view.length = item.needed_whole("byteLength", 1, any);
  view.stride = item.whole("byteStride", 4, 252).value_or(0);
  if (view.stride % 4 != 0) item.fail(fmt::format("\"byteStride\" is {}; it must be a multiple of 4", view.stride));
  if (const auto packed = meshopt_of(item)) {
    // Its own buffer is a fallback for readers that do not know the extension, and need not exist.
    fallback_[view.buffer] = 1;
    view = read_packed(*packed, view.length, view.stride);
  } else {
    check_fit(item, view, read_buffer(view.buffer));
  }
  views_[v] = view;
  return *views_[v];
}

DracoSource DataReader::read_stream(const Item& extension) {
  DracoSource stream;
  stream.view = extension.needed_index("bufferView", "buffer view", views_.size());
  stream.bytes = read_view(stream.view);
  claim(at("bufferViews", "buffer view", stream.view), stream.bytes.length);
  const Item attributes = extension.needed_item("attributes");
  for (const auto& [name, id] : attributes.json().items())
    stream.attributes.emplace(name, attributes.needed_whole(name.c_str(), 0, any));
  if (!stream.attributes.contains("POSITION")) attributes.fail("\"POSITION\" is missing");
  return stream;
}

// Adds a new buffer for the unpacked data, which the result is.
View DataReader::read_packed(const Item& item, std::uint64_t length, std::uint64_t stride) {
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
  if (packed.stride * packed.count != length) {
    item.fail(fmt::format("unpacks to {} elements of {} bytes, but the buffer view has {} bytes", packed.count,
                          packed.stride, length));
  }
  if (stride != 0 && stride != packed.stride)
    item.fail(fmt::format("has a byteStride of {}, but the buffer view has one of {}", packed.stride, stride));
  check_fit(item, {packed.buffer, packed.offset, packed.length}, read_buffer(packed.buffer));
  claim(item, length);
  document_.buffers.push_back({length, {}, packed});
  return {static_cast<std::uint32_t>(document_.buffers.size() - 1), 0, length, stride};
}

void DataReader::claim(const Item& item, std::uint64_t bytes) {
  total_ += std::min(bytes, most_buffer_bytes + 1);
  if (total_ > most_buffer_bytes) {
    item.fail(fmt::format("brings the buffers to more than {} bytes, packed and unpacked; palpa reads no more",
                          most_buffer_bytes));
  }
}

std::uint64_t DataReader::read_buffer(std::uint32_t b) {
  BufferSource& source = document_.buffers[b];
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

void DataReader::check_rest() {
  for (std::uint32_t i = 0; i < views_.size(); ++i)
    read_view(i);
  for (std::uint32_t i = 0; i < fallback_.size(); ++i) {
    if (!fallback_[i]) read_buffer(i);
  }
  for (std::uint32_t i = 0; i < role_.size(); ++i) {
    if (role_[i] == Role::unused) {
      role_[i] = Role::position;  // any role other than the requested one
      read(i, Role::unused);
    }
  }
}

}  // namespace palpa::geometry::gltf
