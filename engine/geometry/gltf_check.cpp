#include "geometry/gltf_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf_json.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max() / 4;  // leaves room to add two of them
constexpr int u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126;

// Extensions that cannot change where a triangle is: a file may require them.
bool is_harmless(std::string_view extension) {
  constexpr std::array<std::string_view, 12> prefixes{
      "KHR_materials_", "EXT_materials_", "KHR_texture_",  "EXT_texture_", "MSFT_texture_", "KHR_lights_",
      "EXT_lights_",    "KHR_xmp",        "KHR_animation", "KHR_audio",    "MSFT_packing",  "FB_ngon_encoding"};
  return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return extension.starts_with(p); });
}

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

class Checker {
 public:
  Checker(const std::string& file, const Json& json, const Container& container)
      : file_(file), root_(file, json, "the document"), container_(container) {}

  Document run(std::optional<int> scene_index) {
    check_root();
    node_count_ = size("nodes");
    check_nodes();
    Document document;
    document.roots = choose_scene(scene_index);
    const std::size_t meshes = walk(document.roots);
    if (const std::string fault = fault_elsewhere(); !fault.empty()) {
      if (meshes == 0) throw bad_input(file_, fault);
      log::warning(file_ + ": " + fault + " (the scene does not need it)");
    }
    document.json = clean_.dump(-1, ' ', false, Json::error_handler_t::replace);
    document.buffers = std::move(buffers_);
    return document;
  }

 private:
  const Json* list(const char* key) const { return root_.array(key); }
  std::size_t size(const char* key) const {
    const Json* items = list(key);
    return items == nullptr ? 0 : items->size();
  }
  Item at(const char* key, const char* name, std::size_t index) const {
    return {file_, (*list(key))[index], fmt::format("{} {}", name, index)};
  }

  void check_root() {
    const Item asset = root_.needed_item("asset");
    const auto version = asset.string("version");
    if (!version) throw bad_input(file_, "\"asset\" lacks \"version\"; palpa reads glTF 2.0");
    if (!version->starts_with("2.") || version->find_first_not_of("0123456789", 2) != std::string::npos ||
        version->size() < 3) {
      throw bad_input(file_, fmt::format("is glTF of version {}; palpa reads glTF 2.0", text::quoted(*version)));
    }
    const auto least = asset.string("minVersion");
    if (least && *least != "2.0") {
      throw bad_input(file_, fmt::format("needs a reader of glTF {}; palpa reads glTF 2.0", text::quoted(*least)));
    }
    if (const Json* required = list("extensionsRequired")) {
      for (const Json& name : *required) {
        if (!name.is_string()) root_.fail("\"extensionsRequired\" holds something that is not a name");
        const auto& extension = name.get_ref<const std::string&>();
        if (!is_harmless(extension)) {
          throw bad_input(
              file_, fmt::format("requires the extension {}, which palpa does not support", text::quoted(extension)));
        }
      }
    }
    clean_ = {{"asset", {{"version", "2.0"}}}};
    // Stand-ins, replaced as needed.
    const auto stand_in = [&](const char* key, const Json& value) {
      if (const std::size_t count = size(key); count > 0) clean_[key] = Json::array_t(count, value);
    };
    stand_in("buffers", {{"byteLength", 1}, {"uri", "unused"}});
    stand_in("bufferViews", {{"buffer", 0}, {"byteLength", 1}});
    stand_in("accessors", {{"componentType", f32}, {"count", 1}, {"type", "SCALAR"}});
    stand_in("meshes", Json::object());
    stand_in("nodes", Json::object());
    buffers_.resize(size("buffers"));
    mesh_checked_.assign(size("meshes"), 0);
    view_checked_.assign(size("bufferViews"), 0);
    accessor_role_.assign(size("accessors"), 0);
  }

  // One parent at most, no loops: a forest.
  void check_nodes() {
    constexpr std::uint32_t none = 0xffffffffU;
    parent_.assign(node_count_, none);
    children_.resize(node_count_);
    for (std::uint32_t n = 0; n < node_count_; ++n) {
      const Item node = at("nodes", "node", n);
      children_[n] = node.indices("children", "node", node_count_);
      for (const std::uint32_t child : children_[n]) {
        if (child == n) node.fail("is its own child");
        if (parent_[child] != none) {
          throw bad_input(
              file_, fmt::format("node {} is a child of both node {} and node {}; the nodes of glTF form trees", child,
                                 parent_[child], n));
        }
        parent_[child] = n;
      }
    }
    std::vector<std::uint32_t> stack;
    std::vector<char> seen(node_count_, 0);
    for (std::uint32_t n = 0; n < node_count_; ++n) {
      if (parent_[n] == none) stack.push_back(n);
    }
    is_root_.assign(node_count_, 0);
    for (const std::uint32_t n : stack)
      is_root_[n] = 1;
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      seen[n] = 1;
      stack.insert(stack.end(), children_[n].begin(), children_[n].end());
    }
    const auto lost = std::find(seen.begin(), seen.end(), 0);
    if (lost != seen.end()) {
      throw bad_input(file_, fmt::format("node {} is its own descendant: the nodes form a loop", lost - seen.begin()));
    }
  }

  std::vector<std::uint32_t> choose_scene(std::optional<int> wanted) {
    const std::size_t scenes = size("scenes");
    std::size_t index = 0;
    if (wanted) {
      if (*wanted < 0 || static_cast<std::size_t>(*wanted) >= scenes) {
        throw bad_input(file_, fmt::format("has no scene {}; it has {} (counted from 0)", *wanted, scenes));
      }
      index = static_cast<std::size_t>(*wanted);
    } else {
      index = root_.index("scene", "scene", scenes).value_or(0);
    }
    std::vector<std::uint32_t> roots;
    if (scenes == 0) {
      for (std::uint32_t n = 0; n < node_count_; ++n) {
        if (is_root_[n]) roots.push_back(n);
      }
      return roots;
    }
    const Item scene = at("scenes", "scene", index);
    roots = scene.indices("nodes", "node", node_count_);
    for (const std::uint32_t n : roots) {
      if (!is_root_[n])
        scene.fail(fmt::format("names node {}, which is a child of node {}; a scene lists root nodes", n, parent_[n]));
    }
    return roots;
  }

  // Checks and copies all that the roots lead to; the number of nodes with a mesh.
  std::size_t walk(const std::vector<std::uint32_t>& roots) {
    std::size_t meshes = 0;
    std::vector<std::uint32_t> stack(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      stack.insert(stack.end(), children_[n].rbegin(), children_[n].rend());
      if (check_node(n)) ++meshes;
    }
    return meshes;
  }

  bool check_node(std::uint32_t n) {
    const Item node = at("nodes", "node", n);
    Json& clean = clean_["nodes"][n];
    if (const auto name = node.string("name")) clean["name"] = *name;
    if (!children_[n].empty()) clean["children"] = children_[n];
    if (const auto matrix = node.numbers("matrix", 16)) {
      if (node.has("translation") || node.has("rotation") || node.has("scale")) {
        node.fail("has both \"matrix\" and translation, rotation or scale; it may have only one of the two");
      }
      const auto& m = *matrix;
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        node.fail("\"matrix\" is not affine: its last row is not 0 0 0 1");
      clean["matrix"] = m;
    }
    for (const char* key : {"translation", "scale"}) {
      if (const auto values = node.numbers(key, 3)) clean[key] = *values;
    }
    if (const auto q = node.numbers("rotation", 4)) {
      const double norm = (*q)[0] * (*q)[0] + (*q)[1] * (*q)[1] + (*q)[2] * (*q)[2] + (*q)[3] * (*q)[3];
      if (!(norm > 0.98 && norm < 1.02)) node.fail("\"rotation\" is not a unit quaternion");
      clean["rotation"] = *q;
    }
    const auto mesh = node.index("mesh", "mesh", mesh_checked_.size());
    if (!mesh) return false;
    clean["mesh"] = *mesh;
    if (node.has("skin")) {
      log::warning(
          fmt::format("{}: node {} is skinned; its mesh is taken as it is stored, not as its bones stand", file_, n));
    }
    check_mesh(*mesh);
    return true;
  }

  void check_mesh(std::uint32_t m) {
    if (mesh_checked_[m]) return;
    mesh_checked_[m] = 1;
    const Item mesh = at("meshes", "mesh", m);
    Json clean = Json::object();
    if (const auto name = mesh.string("name")) clean["name"] = *name;
    const Json* primitives = mesh.array("primitives");
    if (primitives == nullptr || primitives->empty()) mesh.fail("has no primitives");
    clean["primitives"] = Json::array();
    for (std::size_t p = 0; p < primitives->size(); ++p) {
      const Item primitive(file_, (*primitives)[p], fmt::format("mesh {}, primitive {}", m, p));
      Json checked = check_primitive(primitive);
      if (!checked.is_null()) clean["primitives"].push_back(std::move(checked));
    }
    clean_["meshes"][m] = std::move(clean);
  }

  // Null for points, lines and what has no positions.
  Json check_primitive(const Item& primitive) {
    const std::uint64_t mode = primitive.whole("mode", 0, 6).value_or(4);
    const Item attributes = primitive.needed_item("attributes");
    const auto position = attributes.index("POSITION", "accessor", accessor_role_.size());
    if (mode < 4) return {};
    if (!position) {
      log::warning(fmt::format("{}: {} has no POSITION and is left out", file_, primitive.where()));
      return {};
    }
    if (primitive.has_extension("KHR_draco_mesh_compression") &&
        !at("accessors", "accessor", *position).has("bufferView")) {
      primitive.fail("is stored with the extension KHR_draco_mesh_compression only, which palpa does not support");
    }
    Json clean{{"mode", mode}, {"attributes", {{"POSITION", *position}}}};
    check_accessor(*position, Role::position);
    if (const auto indices = primitive.index("indices", "accessor", accessor_role_.size())) {
      check_accessor(*indices, Role::indices);
      clean["indices"] = *indices;
    }
    return clean;
  }

  enum class Role : char { unused, position, indices };

  void check_accessor(std::uint32_t a, Role role) {
    const Item accessor = at("accessors", "accessor", a);
    if (accessor_role_[a] != 0) {
      if (accessor_role_[a] != static_cast<char>(role)) accessor.fail("is used both for positions and for indices");
      return;
    }
    accessor_role_[a] = static_cast<char>(role);
    const std::uint64_t component = accessor.needed_whole("componentType", 5120, 5126);
    const std::uint64_t count = accessor.needed_whole("count", 1, any);
    const std::string type = accessor.string("type").value_or("");
    const std::uint64_t element = component_size(component) * component_count(type);
    if (element == 0)
      accessor.fail(fmt::format("has the unknown type {} of component type {}", text::quoted(type), component));
    if (role == Role::position) {
      if (type != "VEC3") accessor.fail(fmt::format("holds positions as {}; they are VEC3", text::quoted(type)));
      if (component != f32) {
        accessor.fail(fmt::format(
            "holds positions of component type {}; without the extension KHR_mesh_quantization, which palpa "
            "does not support, they are 32-bit floats (5126)",
            component));
      }
    } else if (type != "SCALAR" || (component != u8 && component != u16 && component != u32)) {
      accessor.fail("holds indices that are not scalar unsigned integers of 8, 16 or 32 bits (5121, 5123, 5125)");
    }
    Json clean{{"componentType", component}, {"count", count}, {"type", type}};
    const auto view = accessor.index("bufferView", "buffer view", view_checked_.size());
    const std::uint64_t offset = accessor.whole("byteOffset", 0, any).value_or(0);
    if (view) {
      const View found = check_view(*view);
      if (role == Role::indices && found.stride != 0) accessor.fail("holds indices in a buffer view with a byteStride");
      check_fit(accessor, found, offset, count, found.stride == 0 ? element : found.stride, element);
      if (offset % component_size(component) != 0) {
        log::warning(fmt::format("{}: {} starts at byte {}, not at a multiple of its components' size", file_,
                                 accessor.where(), offset));
      }
      clean["bufferView"] = *view;
      clean["byteOffset"] = offset;
    } else if (role == Role::indices || !accessor.has("sparse")) {
      accessor.fail("has no data: \"bufferView\" is missing");
    } else if (offset != 0) {
      accessor.fail("has a \"byteOffset\" but no \"bufferView\"");
    }
    if (const auto sparse = accessor.item("sparse")) clean["sparse"] = check_sparse(*sparse, count, element);
    clean_["accessors"][a] = std::move(clean);
  }

  Json check_sparse(const Item& sparse, std::uint64_t accessor_count, std::uint64_t element) {
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

  struct View {
    std::uint64_t length, stride;
  };

  static void check_fit(const Item& item, const View& view, std::uint64_t offset, std::uint64_t count,
                        std::uint64_t stride, std::uint64_t element) {
    if (stride < element)
      item.fail(fmt::format("has elements of {} bytes, but its buffer view a byteStride of {}", element, stride));
    if (offset > view.length || view.length - offset < element ||
        count - 1 > (view.length - offset - element) / stride) {
      item.fail(fmt::format("does not fit its buffer view: {} elements, {} bytes apart, from byte {} on, in {} bytes",
                            count, stride, offset, view.length));
    }
  }

  View check_view(std::uint32_t v) {
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
      view.fail(
          fmt::format("does not fit its buffer: {} bytes from byte {} on, in {} bytes", length, offset, available));
    }
    Json clean{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
    if (stride) clean["byteStride"] = *stride;
    clean_["bufferViews"][v] = std::move(clean);
    return {length, stride.value_or(0)};
  }

  std::uint64_t check_buffer(std::uint32_t b) {
    BufferSource& source = buffers_[b];
    if (source.length != 0) return source.length;
    const Item buffer = at("buffers", "buffer", b);
    const std::uint64_t length = buffer.needed_whole("byteLength", 1, any);
    const auto uri = buffer.string("uri");
    if (!uri) {
      if (b != 0 || !container_.bin) buffer.fail("has no \"uri\", and there is no BIN chunk that could be it");
      if (length > container_.bin->size) {
        buffer.fail(fmt::format("\"byteLength\" is {}, but the BIN chunk has {} bytes", length, container_.bin->size));
      }
    } else if (uri->empty()) {
      buffer.fail("\"uri\" is empty");
    }
    total_ += std::min(length, most_buffer_bytes + 1);
    if (total_ > most_buffer_bytes) {
      buffer.fail(
          fmt::format("\"byteLength\" is {}; palpa reads at most {} bytes of buffers", length, most_buffer_bytes));
    }
    source = {length, uri.value_or("")};
    clean_["buffers"][b] = {{"byteLength", length}, {"uri", fmt::format("buffer {}", b)}};
    return length;
  }

  // The first fault of what the scene has not led to; empty if there is none.
  std::string fault_elsewhere() {
    const Json kept = clean_;
    const std::vector<BufferSource> kept_buffers = buffers_;
    std::string fault;
    try {
      for (const char* key : {"animations", "cameras", "images", "materials", "samplers", "scenes", "skins", "textures",
                              "buffers", "bufferViews", "accessors", "meshes"}) {
        for (std::size_t i = 0; i < size(key); ++i)
          at(key, key, i);
      }
      for (std::uint32_t i = 0; i < buffers_.size(); ++i)
        check_buffer(i);
      for (std::uint32_t i = 0; i < view_checked_.size(); ++i)
        check_view(i);
      for (std::uint32_t i = 0; i < mesh_checked_.size(); ++i)
        check_mesh(i);
      for (std::uint32_t i = 0; i < node_count_; ++i)
        at("nodes", "node", i).index("mesh", "mesh", mesh_checked_.size());
      for (std::uint32_t i = 0; i < accessor_role_.size(); ++i) {
        if (accessor_role_[i] != 0) continue;
        const Item accessor = at("accessors", "accessor", i);
        accessor.needed_whole("componentType", 5120, 5126);
        accessor.needed_whole("count", 1, any);
        if (component_count(accessor.string("type").value_or("")) == 0) accessor.fail("has an unknown \"type\"");
        accessor.index("bufferView", "buffer view", view_checked_.size());
      }
    } catch (const Error& e) {
      fault = std::string(e.what()).substr(file_.size() + 2);
    }
    clean_ = kept;
    buffers_ = kept_buffers;
    return fault;
  }

  const std::string& file_;
  Item root_;
  const Container& container_;
  Json clean_;
  std::size_t node_count_ = 0;
  std::vector<std::uint32_t> parent_;
  std::vector<std::vector<std::uint32_t>> children_;
  std::vector<char> is_root_, mesh_checked_, view_checked_, accessor_role_;
  std::vector<BufferSource> buffers_;
  std::uint64_t total_ = 0;
};

}  // namespace

Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index) {
  const Json json = parse_json(file, container.json);
  return Checker(file, json, container).run(scene_index);
}

}  // namespace palpa::geometry::gltf
