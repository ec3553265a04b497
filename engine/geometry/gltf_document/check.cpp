#include "geometry/gltf_document/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <tuple>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/outputs.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/gltf_document/data.hpp"
#include "geometry/gltf_document/extensions.hpp"
#include "geometry/gltf_document/extras.hpp"
#include "geometry/gltf_document/json.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

// Maximum number of nodes, meshes, primitives, accessors and the like: tinygltf needs up to a kilobyte for each.
constexpr std::size_t most_items = 50'000;

class Checker {
 public:
  Checker(const std::string& file, const Parsed& parsed, const Container& container)
      : file_(file), parsed_(parsed), root_(file, parsed.json(), "the document"), data_(root_, parsed, container) {}

  Document run(std::optional<int> scene_index) {
    check_root();
    node_count_ = size("nodes");
    check_nodes();
    Document document;
    document.roots = choose_scene(scene_index);
    haptics_.resize(node_count_);
    parts_.resize(node_count_);
    hidden_.resize(node_count_);
    const std::size_t meshes = walk(document.roots);
    warn_of_unknown_keys();
    warn_of_hidden();
    document.parents = parent_;
    document.haptics = haptics_;
    document.parts = parts_;
    document.instancing = instancing_;
    document.json = clean_.dump(-1, ' ', false, Json::error_handler_t::replace);
    document.buffers = data_.buffers();
    document.without_view = data_.without_view();
    document.draco = draco_;
    std::sort(document.draco.begin(), document.draco.end(), [](const DracoSource& a, const DracoSource& b) {
      return std::pair(a.mesh, a.primitive) < std::pair(b.mesh, b.primitive);
    });
    // The reduced document is complete here; the following check may spoil clean_.
    if (const std::string fault = fault_elsewhere(); !fault.empty()) {
      if (meshes == 0) throw bad_input(file_, fault);
      log::warning(file_ + ": " + fault + " (the scene does not need it)");
    }
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
        if (!may_be_required(extension)) {
          throw bad_input(
              file_, fmt::format("requires the extension {}, which palpa does not support", text::quoted(extension)));
        }
      }
    }
    clean_ = {{"asset", {{"version", "2.0"}}}};
    for (const char* key : {"accessors", "bufferViews", "buffers", "meshes", "nodes", "scenes", "skins"}) {
      if (size(key) > most_items)
        throw bad_input(file_, fmt::format("has {} {}; palpa reads at most {}", size(key), key, most_items));
    }
    data_.start(clean_);
    for (const char* key : {"meshes", "nodes"}) {
      if (size(key) > 0) clean_[key] = Json::array_t(size(key), Json::object());
    }
    // tinygltf rejects a skin without joints.
    if (size("skins") > 0) clean_["skins"] = Json::array_t(size("skins"), {{"joints", {0}}});
    mesh_checked_.assign(size("meshes"), 0);
    skin_checked_.assign(size("skins"), 0);
  }

  // Each node has at most one parent, and there are no loops: a forest.
  void check_nodes() {
    constexpr std::uint32_t none = Document::no_parent;
    parent_.assign(node_count_, none);
    transform_checked_.assign(node_count_, 0);
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

  // Checks and copies everything that the roots refer to; returns the number of nodes with a mesh.
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

  // Returns true if the node shows a mesh.
  bool check_node(std::uint32_t n) {
    const Item node = at("nodes", "node", n);
    check_transform(n);
    const NodeHaptics extras = read_extras(node, unknown_keys_);
    haptics_[n] = inherit(node, extras, parent_[n] == Document::no_parent ? Haptics{} : haptics_[parent_[n]]);
    if (extras.part_of) parts_[n] = PartOf{*extras.part_of, parent_[n], extras.seam_m.value_or(0)};
    hidden_[n] = is_hidden(node) || (parent_[n] != Document::no_parent && hidden_[parent_[n]] != 0) ? 1 : 0;
    Json& clean = clean_["nodes"][n];
    if (const auto name = node.string("name")) clean["name"] = parsed_.whole_name(*name);
    if (!children_[n].empty()) clean["children"] = children_[n];
    const auto mesh = node.index("mesh", "mesh", mesh_checked_.size());
    if (!mesh) return false;
    clean["mesh"] = *mesh;
    if (hidden_[n] != 0 && hidden_count_++ == 0) first_hidden_ = node.where();
    const std::size_t targets = check_mesh(*mesh);
    if (const Json* weights = node.array("weights"); weights != nullptr && !weights->empty()) {
      clean["weights"] = node.numbers("weights", targets).value();
    }
    if (const auto skin = node.index("skin", "skin", skin_checked_.size())) {
      check_skin(*skin);
      clean["skin"] = *skin;
    }
    if (node.has_extension(instancing_extension)) check_instancing(n, node, clean.contains("skin"));
    return true;
  }

  void check_instancing(std::uint32_t n, const Item& node, bool skinned) {
    if (skinned) {
      log::warning(fmt::format("{}: {}: {} has no effect on a skinned node, whose bones place its mesh", file_,
                               node.where(), instancing_extension));
      return;
    }
    const Item item = node.needed_item("extensions").needed_item(instancing_extension);
    const Item attributes = item.needed_item("attributes");
    Instancing found;
    for (const auto& [name, role, into] :
         {std::tuple("TRANSLATION", Role::place, &found.translation),
          std::tuple("ROTATION", Role::rotation, &found.rotation), std::tuple("SCALE", Role::place, &found.scale)}) {
      *into = attributes.index(name, "accessor", data_.accessor_count());
      if (!*into) continue;
      const std::uint64_t count = data_.check(**into, role);
      if (found.count != 0 && count != found.count)
        attributes.fail(fmt::format("has {} instances, but {} of {}", found.count, count, name));
      found.count = count;
    }
    if (found.count == 0) attributes.fail("has neither TRANSLATION nor ROTATION nor SCALE");
    instancing_.emplace(n, found);
  }

  // KHR_node_visibility of the node itself.
  bool is_hidden(const Item& node) const {
    if (!node.has_extension(visibility_extension)) return false;
    const Item item = node.needed_item("extensions").needed_item(visibility_extension);
    const auto visible = item.json().find("visible");
    if (visible == item.json().end()) return false;
    if (!visible->is_boolean()) item.fail("\"visible\" is neither true nor false");
    return !visible->get<bool>();
  }

  void warn_of_hidden() const {
    if (hidden_count_ == 0) return;
    log::warning(fmt::format(
        "{}: {}{} hidden ({}), but still touchable; extras {{\"palpa\": {{\"touchable\": false}}}} make it scenery",
        file_, first_hidden_,
        hidden_count_ == 1 ? std::string(" is") : fmt::format(" and {} others are", hidden_count_ - 1),
        visibility_extension));
  }

  void warn_of_unknown_keys() const {
    for (const auto& [key, where] : unknown_keys_) {
      log::warning(fmt::format("{}: {}: extras: palpa does not know {}; {}", file_, where, text::quoted(key),
                               explain_unknown(key)));
    }
  }

  void check_transform(std::uint32_t n) {
    if (transform_checked_[n]) return;
    transform_checked_[n] = 1;
    const Item node = at("nodes", "node", n);
    Json& clean = clean_["nodes"][n];
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
  }

  void check_skin(std::uint32_t s) {
    if (skin_checked_[s]) return;
    skin_checked_[s] = 1;
    const Item skin = at("skins", "skin", s);
    const std::vector<std::uint32_t> joints = skin.indices("joints", "node", node_count_);
    if (joints.empty()) skin.fail("has no joints");
    for (std::uint32_t n : joints) {
      for (; n != Document::no_parent && !transform_checked_[n]; n = parent_[n])
        check_transform(n);
    }
    Json& clean = clean_["skins"][s];
    clean["joints"] = joints;
    if (const auto matrices = skin.index("inverseBindMatrices", "accessor", data_.accessor_count())) {
      const std::uint64_t count = data_.check(*matrices, Role::bind_matrices);
      if (count < joints.size())
        skin.fail(fmt::format("has {} joints but only {} inverse bind matrices", joints.size(), count));
      clean["inverseBindMatrices"] = *matrices;
    }
  }

  // Returns the number of its morph targets.
  std::size_t check_mesh(std::uint32_t m) {
    Json& clean = clean_["meshes"][m];
    const Item mesh = at("meshes", "mesh", m);
    const Json* primitives = mesh.array("primitives");
    if (primitives == nullptr || primitives->empty()) mesh.fail("has no primitives");
    const Item first(file_, (*primitives)[0], fmt::format("mesh {}, primitive 0", m));
    const Json* first_targets = first.array("targets");
    const std::size_t targets = first_targets == nullptr ? 0 : first_targets->size();
    if (mesh_checked_[m]) return targets;
    mesh_checked_[m] = 1;
    if (const auto name = mesh.string("name")) clean["name"] = parsed_.whole_name(*name);
    if (has_palpa_extras(mesh)) {
      log::warning(fmt::format(
          "{}: {}: palpa reads the extras of nodes (Blender: the object's custom properties), not those of meshes",
          file_, mesh.where()));
    }
    if (const Json* weights = mesh.array("weights"); weights != nullptr && !weights->empty()) {
      clean["weights"] = mesh.numbers("weights", targets).value();
    }
    clean["primitives"] = Json::array();
    primitives_ += primitives->size();
    if (primitives_ > most_items)
      throw bad_input(file_, fmt::format("has more than {} primitives; palpa reads no more", most_items));
    for (std::size_t p = 0; p < primitives->size(); ++p) {
      const Item primitive(file_, (*primitives)[p], fmt::format("mesh {}, primitive {}", m, p));
      Json checked = check_primitive(primitive, targets, m, static_cast<std::uint32_t>(clean["primitives"].size()));
      if (!checked.is_null()) clean["primitives"].push_back(std::move(checked));
    }
    return targets;
  }

  // Null for points, lines and primitives without positions.
  Json check_primitive(const Item& primitive, std::size_t target_count, std::uint32_t m, std::uint32_t place) {
    const std::uint64_t mode = primitive.whole("mode", 0, 6).value_or(4);
    const Item attributes = primitive.needed_item("attributes");
    const auto position = attributes.index("POSITION", "accessor", data_.accessor_count());
    if (mode < 4) return {};
    if (!position) {
      log::warning(fmt::format("{}: {} has no POSITION and is left out", file_, primitive.where()));
      return {};
    }
    const auto indices = primitive.index("indices", "accessor", data_.accessor_count());
    // An uncompressed copy, if there is one, is more exact.
    const bool packed = primitive.has_extension("KHR_draco_mesh_compression") &&
                        !(data_.has_data(*position) && (!indices || data_.has_data(*indices)));
    std::optional<DracoSource> stream;
    if (packed) stream = check_stream(primitive);
    const auto check_accessor = [&](const std::string& name, std::uint32_t accessor, Role role) {
      return stream && stream->attributes.contains(name) ? data_.check_compressed(accessor, role)
                                                         : data_.check(accessor, role);
    };
    Json clean{{"mode", mode}, {"attributes", {{"POSITION", *position}}}};
    const std::uint64_t vertices = check_accessor("POSITION", *position, Role::position);
    const auto check_count = [&](const Item& item, const std::string& what, std::uint64_t count) {
      if (count != vertices) item.fail(fmt::format("has {} positions but {} of {}", vertices, count, what));
    };
    if (stream) {
      stream->corners = indices ? data_.check_compressed(*indices, Role::indices) : vertices;
    } else if (indices) {
      data_.check(*indices, Role::indices);
      clean["indices"] = *indices;
    }
    for (int set = 0; set < 8; ++set) {
      for (const auto& [prefix, role] : {std::pair("JOINTS_", Role::joints), std::pair("WEIGHTS_", Role::weights)}) {
        const std::string name = prefix + std::to_string(set);
        const auto accessor = attributes.index(name.c_str(), "accessor", data_.accessor_count());
        if (!accessor) continue;
        check_count(primitive, name, check_accessor(name, *accessor, role));
        clean["attributes"][name] = *accessor;
      }
    }
    if (const Json* targets = primitive.array("targets")) {
      if (targets->size() != target_count) {
        primitive.fail(
            fmt::format("has {} morph targets, but the mesh's first primitive has {}", targets->size(), target_count));
      }
      clean["targets"] = Json::array();
      for (std::size_t t = 0; t < targets->size(); ++t) {
        const Item target(file_, (*targets)[t], fmt::format("{}, target {}", primitive.where(), t));
        Json displacement = Json::object();
        if (const auto accessor = target.index("POSITION", "accessor", data_.accessor_count())) {
          check_count(target, "POSITION", data_.check(*accessor, Role::displacement));
          displacement["POSITION"] = *accessor;
        }
        clean["targets"].push_back(std::move(displacement));
      }
    } else if (target_count != 0) {
      primitive.fail(fmt::format("has no morph targets, but the mesh's first primitive has {}", target_count));
    }
    if (stream) {
      stream->primitive = place;
      stream->mesh = m;
      draco_.push_back(*std::move(stream));
    }
    return clean;
  }

  // The extension's object; the caller fills in which primitive it belongs to.
  DracoSource check_stream(const Item& primitive) {
    const Item draco = primitive.needed_item("extensions").needed_item("KHR_draco_mesh_compression");
    DracoSource stream;
    stream.view = draco.needed_index("bufferView", "buffer view", data_.view_count());
    data_.check_stream(stream.view);
    const Item attributes = draco.needed_item("attributes");
    for (const auto& [name, id] : attributes.json().items())
      stream.attributes.emplace(name, attributes.needed_whole(name.c_str(), 0, 0xffffffffU));
    if (!stream.attributes.contains("POSITION")) attributes.fail("\"POSITION\" is missing");
    return stream;
  }

  // The first fault in parts that the scene does not refer to; empty if there is none.
  std::string fault_elsewhere() {
    try {
      for (const char* key :
           {"animations", "cameras", "images", "materials", "samplers", "scenes", "skins", "textures"}) {
        for (std::size_t i = 0; i < size(key); ++i)
          at(key, key, i);
      }
      for (std::uint32_t i = 0; i < node_count_; ++i) {
        at("nodes", "node", i).index("mesh", "mesh", mesh_checked_.size());
        check_transform(i);
      }
      for (std::uint32_t i = 0; i < mesh_checked_.size(); ++i)
        check_mesh(i);
      for (std::uint32_t i = 0; i < skin_checked_.size(); ++i)
        check_skin(i);
      data_.check_rest();
      for (std::size_t i = 0; i < size("textures"); ++i)
        at("textures", "texture", i).index("source", "image", size("images"));
      for (std::size_t i = 0; i < size("materials"); ++i) {
        const auto surface = at("materials", "material", i).item("pbrMetallicRoughness");
        if (!surface) continue;
        const auto texture = surface->item("baseColorTexture");
        if (texture) texture->index("index", "texture", size("textures"));
      }
    } catch (const Error& e) {
      return std::string(e.what()).substr(file_.size() + 2);
    }
    return {};
  }

  const std::string& file_;
  const Parsed& parsed_;
  Item root_;
  Json clean_;
  DataChecker data_;
  std::size_t node_count_ = 0, primitives_ = 0;
  std::vector<std::uint32_t> parent_;
  std::vector<std::vector<std::uint32_t>> children_;
  std::vector<Haptics> haptics_;
  std::vector<std::optional<PartOf>> parts_;
  std::vector<DracoSource> draco_;
  std::map<std::uint32_t, Instancing> instancing_;
  UnknownKeys unknown_keys_;
  std::vector<char> hidden_;  // itself or through an ancestor
  std::size_t hidden_count_ = 0;
  std::string first_hidden_;
  std::vector<char> is_root_, transform_checked_, mesh_checked_, skin_checked_;
};

/// The files that a model refers to belong to it, whether palpa reads them or not.
void refuse_outputs_in(const std::filesystem::path& file, const Json& document) {
  for (const char* key : {"buffers", "images"}) {
    if (!document.is_object() || !document.contains(key) || !document[key].is_array()) continue;
    for (const Json& item : document[key]) {
      if (!item.is_object() || !item.contains("uri") || !item["uri"].is_string()) continue;
      const auto uri = decode_percent(item["uri"].get<std::string>());
      if (uri && !uri->starts_with("data:")) refuse_output_as_input(file.parent_path() / *uri);
    }
  }
}

}  // namespace

Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index) {
  const Parsed parsed(file, container.json);
  refuse_outputs_in(file, parsed.json());
  return Checker(file, parsed, container).run(scene_index);
}

}  // namespace palpa::geometry::gltf
