#include "geometry/gltf_document/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/files/reference.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "geometry/gltf_document/data.hpp"
#include "geometry/gltf_document/extensions.hpp"
#include "geometry/gltf_document/extras.hpp"
#include "geometry/gltf_document/json.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

// Maximum number of nodes, meshes, primitives, accessors and the like: each needs up to a kilobyte.
constexpr std::size_t most_items = 50'000;

// The files that a model refers to belong to it, whether palpa reads them or not.
void refuse_outputs_in(const std::filesystem::path& file, const Json& document) {
  for (const char* key : {"buffers", "images"}) {
    if (!document.is_object() || !document.contains(key) || !document[key].is_array()) continue;
    for (const Json& item : document[key]) {
      if (!item.is_object() || !item.contains("uri") || !item["uri"].is_string()) continue;
      const auto uri = decode_percent(item["uri"].get<std::string>());
      if (!uri || uri->starts_with("data:")) continue;
      for (const std::filesystem::path& meant : readings_of(*uri, file.parent_path()))
        refuse_output_as_input(meant);
    }
  }
}

void check_root(const Item& root) {
  const auto fail = [&](const std::string& fault) { throw bad_input(root.file(), fault); };
  const Item asset = root.needed_item("asset");
  const std::string version = asset.string("version").value_or("");
  if (!asset.has("version")) fail("\"asset\" lacks \"version\"; palpa reads glTF 2.0");
  if (!version.starts_with("2.") || version.find_first_not_of("0123456789", 2) != std::string::npos ||
      version.size() < 3) {
    fail(fmt::format("is glTF of version {}; palpa reads glTF 2.0", text::quoted(version)));
  }
  const std::string least = asset.string("minVersion").value_or("2.0");
  if (least != "2.0") fail(fmt::format("needs a reader of glTF {}; palpa reads glTF 2.0", text::quoted(least)));
  for (std::size_t i = 0; i < root.size("extensionsRequired"); ++i) {
    const Json& name = (*root.array("extensionsRequired"))[i];
    if (!name.is_string()) root.fail("\"extensionsRequired\" holds something that is not a name");
    const auto& extension = name.get_ref<const std::string&>();
    if (!may_be_required(extension))
      fail(fmt::format("requires the extension {}, which palpa does not support", text::quoted(extension)));
  }
  for (const char* key : {"accessors", "bufferViews", "buffers", "meshes", "nodes", "scenes", "skins"}) {
    if (root.size(key) > most_items)
      fail(fmt::format("has {} {}; palpa reads at most {}", root.size(key), key, most_items));
  }
}

void check_transform(const Item& node) {
  if (const auto matrix = node.numbers("matrix", 16)) {
    if (node.has("translation") || node.has("rotation") || node.has("scale")) {
      node.fail("has both \"matrix\" and translation, rotation or scale; it may have only one of the two");
    }
    const auto& m = *matrix;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      node.fail("\"matrix\" is not affine: its last row is not 0 0 0 1");
    return;
  }
  node.numbers("translation", 3);
  node.numbers("scale", 3);
  if (const auto rotation = node.numbers("rotation", 4)) {
    const auto& q = *rotation;
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm > 0.98 && norm < 1.02)) node.fail("\"rotation\" is not a unit quaternion");
  }
}

// KHR_node_visibility of the node itself.
bool is_hidden(const Item& node) {
  if (!node.has_extension(visibility_extension)) return false;
  const Item item = node.needed_item("extensions").needed_item(visibility_extension);
  return item.boolean("visible") == false;
}

class DocumentChecker {
 public:
  DocumentChecker(Item& root, const Parsed& parsed, const Container& container, Document& document)
      : file_(root.file()),
        parsed_(parsed),
        root_(root),
        document_(document),
        data_(root, parsed, container, document) {
    const std::size_t nodes = root.size("nodes");
    document.parents.resize(nodes, Document::no_parent);
    document.haptics.resize(nodes);
    document.parts.resize(nodes);
    children_.resize(nodes);
    transform_checked_.resize(nodes);
    hidden_.resize(nodes);
    mesh_checked_.resize(root.size("meshes"));
    skin_checked_.resize(root.size("skins"));
  }

  void check(std::optional<int> scene_index) {
    check_tree();
    walk(choose_scene(scene_index));
    warn_of_unknown_keys();
    if (hidden_count_ > 0) {
      log::warning(fmt::format(
          "{}: {} hidden ({}), but still touchable; extras {{\"palpa\": {{\"touchable\": false}}}} make it scenery",
          file_, first_is(first_hidden_, hidden_count_), visibility_extension));
    }
    root_.stop_writing();
    std::vector<BufferSource> needed = document_.buffers;
    if (const std::string fault = fault_elsewhere(); !fault.empty()) {
      if (document_.shown.empty()) throw bad_input(file_, fault);
      log::warning(file_ + ": " + fault + " (the scene does not need it)");
    }
    document_.buffers = std::move(needed);
  }

 private:
  Item at(const char* key, const char* name, std::size_t index) const { return root_.element(key, name, index); }
  std::size_t node_count() const { return children_.size(); }

  // Each node has at most one parent, and there are no loops: a forest.
  void check_tree() {
    for (std::uint32_t n = 0; n < node_count(); ++n) {
      const Item node = at("nodes", "node", n);
      children_[n] = node.indices("children", "node", node_count());
      for (const std::uint32_t child : children_[n]) {
        std::uint32_t& parent = document_.parents[child];
        if (child == n) node.fail("is its own child");
        if (parent != Document::no_parent) {
          throw bad_input(
              file_, fmt::format("node {} is a child of both node {} and node {}; the nodes of glTF form trees", child,
                                 parent, n));
        }
        parent = n;
      }
    }
    std::vector<std::uint32_t> stack = roots();
    std::vector<char> seen(node_count(), 0);
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

  std::vector<std::uint32_t> roots() const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t n = 0; n < node_count(); ++n) {
      if (document_.parents[n] == Document::no_parent) found.push_back(n);
    }
    return found;
  }

  // Returns its root nodes.
  std::vector<std::uint32_t> choose_scene(std::optional<int> wanted) {
    const std::size_t scenes = root_.size("scenes");
    std::size_t index = 0;
    if (wanted) {
      if (*wanted < 0 || static_cast<std::size_t>(*wanted) >= scenes) {
        throw bad_input(file_, fmt::format("has no scene {}; it has {} (counted from 0)", *wanted, scenes));
      }
      index = static_cast<std::size_t>(*wanted);
    } else {
      index = root_.index("scene", "scene", scenes).value_or(0);
    }
    if (scenes == 0) return roots();
    const Item scene = at("scenes", "scene", index);
    std::vector<std::uint32_t> chosen = scene.indices("nodes", "node", node_count());
    for (const std::uint32_t n : chosen) {
      const std::uint32_t parent = document_.parents[n];
      if (parent != Document::no_parent)
        scene.fail(fmt::format("names node {}, which is a child of node {}; a scene lists root nodes", n, parent));
    }
    return chosen;
  }

  void walk(const std::vector<std::uint32_t>& from) {
    std::vector<std::uint32_t> stack(from.rbegin(), from.rend());
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      stack.insert(stack.end(), children_[n].rbegin(), children_[n].rend());
      check_node(n);
    }
  }

  void check_node(std::uint32_t n) {
    const Item item = at("nodes", "node", n);
    const std::uint32_t parent = document_.parents[n];
    const bool is_root = parent == Document::no_parent;
    check_transforms(n);
    const NodeHaptics extras = read_extras(item, unknown_keys_);
    document_.haptics[n] = inherit(item, extras, is_root ? Haptics{} : document_.haptics[parent]);
    if (extras.part_of) document_.parts[n] = PartOf{*extras.part_of, parent, extras.seam_m.value_or(0)};
    hidden_[n] = is_hidden(item) || (!is_root && hidden_[parent] != 0) ? 1 : 0;
    check_name(item);
    const auto mesh = item.index("mesh", "mesh", mesh_checked_.size());
    if (!mesh) return;
    document_.shown.push_back(n);
    if (hidden_[n] != 0 && hidden_count_++ == 0) first_hidden_ = item.where();
    check_weights(item, check_mesh(*mesh));
    const auto skin = item.index("skin", "skin", skin_checked_.size());
    if (skin) check_skin(*skin);
    if (!item.has_extension(instancing_extension)) return;
    if (!skin) {
      check_instancing(item);
    } else {
      item.warn(fmt::format("{} has no effect on a skinned node, whose bones place its mesh", instancing_extension));
    }
  }

  void check_name(const Item& item) const {
    if (const auto name = item.string("name")) item.write("name", parsed_.whole(*name));
  }

  static void check_weights(const Item& item, std::size_t targets) {
    if (item.size("weights") != 0) item.numbers("weights", targets);
  }

  // The transforms of the node and of its ancestors.
  void check_transforms(std::uint32_t n) {
    for (; n != Document::no_parent && transform_checked_[n] == 0; n = document_.parents[n]) {
      transform_checked_[n] = 1;
      check_transform(at("nodes", "node", n));
    }
  }

  void check_instancing(const Item& node) {
    const Item attributes = node.needed_item("extensions").needed_item(instancing_extension).needed_item("attributes");
    std::uint64_t instances = 0;
    for (const auto& [name, role] : {std::pair("TRANSLATION", Role::place), std::pair("ROTATION", Role::rotation),
                                     std::pair("SCALE", Role::place)}) {
      const auto accessor = data_.named(attributes, name);
      if (!accessor) continue;
      const std::uint64_t count = data_.check(*accessor, role);
      if (instances != 0 && count != instances)
        attributes.fail(fmt::format("has {} instances, but {} of {}", instances, count, name));
      instances = count;
    }
    if (instances == 0) attributes.fail("has neither TRANSLATION nor ROTATION nor SCALE");
  }

  void check_skin(std::uint32_t s) {
    if (skin_checked_[s]) return;
    skin_checked_[s] = 1;
    const Item item = at("skins", "skin", s);
    const std::vector<std::uint32_t> joints = item.indices("joints", "node", node_count());
    if (joints.empty()) item.fail("has no joints");
    for (const std::uint32_t n : joints)
      check_transforms(n);
    const auto matrices = data_.named(item, "inverseBindMatrices");
    if (!matrices) return;
    const std::uint64_t count = data_.check(*matrices, Role::bind_matrices);
    if (count < joints.size())
      item.fail(fmt::format("has {} joints but only {} inverse bind matrices", joints.size(), count));
  }

  // Returns the number of its morph targets.
  std::size_t check_mesh(std::uint32_t m) {
    const Item item = at("meshes", "mesh", m);
    const std::size_t primitives = item.size("primitives");
    if (primitives == 0) item.fail("has no primitives");
    const std::string name = item.where() + ", primitive";
    const std::size_t targets = item.element("primitives", name, 0).size("targets");
    if (mesh_checked_[m]) return targets;
    mesh_checked_[m] = 1;
    check_name(item);
    if (has_palpa_extras(item)) item.warn(extras_belong_to_nodes);
    check_weights(item, targets);
    primitives_ += primitives;
    if (primitives_ > most_items)
      throw bad_input(file_, fmt::format("has more than {} primitives; palpa reads no more", most_items));
    for (std::size_t p = 0; p < primitives; ++p) {
      const Item primitive = item.element("primitives", name, p);
      if (!check_primitive(primitive, targets)) primitive.forget();
    }
    return targets;
  }

  // False for points, lines and primitives without positions.
  bool check_primitive(const Item& item, std::size_t targets) {
    const bool triangles = item.whole("mode", 0, 6).value_or(4) >= 4;
    const Item attributes = item.needed_item("attributes");
    const auto position = data_.named(attributes, "POSITION");
    if (!triangles) return false;
    if (!position) {
      item.warn("has no POSITION and is left out");
      return false;
    }
    const auto indices = data_.named(item, "indices");
    std::optional<Item> stream;
    // An uncompressed copy, if there is one, is more exact.
    if (item.has_extension(draco_extension) && !(data_.has_data(*position) && (!indices || data_.has_data(*indices))))
      stream = data_.check_stream(item.needed_item("extensions").needed_item(draco_extension));
    const auto check_attribute = [&](std::uint32_t accessor, const std::string& name, Role role) {
      return stream && stream->has(name.c_str()) ? data_.check_compressed(accessor, role) : data_.check(accessor, role);
    };
    const std::uint64_t vertices = check_attribute(*position, "POSITION", Role::position);
    const auto check_count = [&](const Item& where, const std::string& name, std::uint64_t count) {
      if (count != vertices) where.fail(fmt::format("has {} positions but {} of {}", vertices, count, name));
    };
    if (indices) stream ? data_.check_compressed(*indices, Role::indices) : data_.check(*indices, Role::indices);
    for (int set = 0; set < 8; ++set) {
      for (const auto& [prefix, role] : {std::pair("JOINTS_", Role::joints), std::pair("WEIGHTS_", Role::weights)}) {
        const std::string name = prefix + std::to_string(set);
        const auto accessor = data_.named(attributes, name.c_str());
        if (accessor) check_count(item, name, check_attribute(*accessor, name, role));
      }
    }
    if (item.size("targets") != targets) {
      item.fail(fmt::format("has {} morph targets, but the mesh's first primitive has {}",
                            item.has("targets") ? fmt::to_string(item.size("targets")) : "no", targets));
    }
    for (std::size_t t = 0; t < targets; ++t) {
      const Item target = item.element("targets", item.where() + ", target", t);
      const auto accessor = data_.named(target, "POSITION");
      if (accessor) check_count(target, "POSITION", data_.check(*accessor, Role::displacement));
    }
    return true;
  }

  void warn_of_unknown_keys() const {
    for (const auto& [key, where] : unknown_keys_) {
      log::warning(fmt::format("{}: {}: extras: palpa does not know {}; {}", file_, where, text::quoted(key),
                               explain_unknown(key)));
    }
    for (const std::string& where : extras_elsewhere(root_))
      log::warning(fmt::format("{}: {}: {}", file_, where, extras_belong_to_nodes));
  }

  // The first fault in parts that the scene does not refer to; empty if there is none.
  std::string fault_elsewhere() {
    try {
      for (const char* key :
           {"animations", "cameras", "images", "materials", "samplers", "scenes", "skins", "textures"}) {
        for (std::size_t i = 0; i < root_.size(key); ++i)
          at(key, key, i);
      }
      for (std::uint32_t i = 0; i < node_count(); ++i) {
        const Item node = at("nodes", "node", i);
        node.index("mesh", "mesh", mesh_checked_.size());
        check_transform(node);
      }
      for (std::uint32_t i = 0; i < mesh_checked_.size(); ++i)
        check_mesh(i);
      for (std::uint32_t i = 0; i < skin_checked_.size(); ++i)
        check_skin(i);
      data_.check_rest();
      for (std::size_t i = 0; i < root_.size("textures"); ++i)
        at("textures", "texture", i).index("source", "image", root_.size("images"));
      for (std::size_t i = 0; i < root_.size("materials"); ++i) {
        const auto surface = at("materials", "material", i).item("pbrMetallicRoughness");
        if (!surface) continue;
        const auto texture = surface->item("baseColorTexture");
        if (texture) texture->index("index", "texture", root_.size("textures"));
      }
    } catch (const Error& e) {
      return std::string(e.what()).substr(file_.size() + 2);
    }
    return {};
  }

  const std::string& file_;
  const Parsed& parsed_;
  Item& root_;
  Document& document_;
  DataChecker data_;
  std::vector<std::vector<std::uint32_t>> children_;
  UnknownKeys unknown_keys_;
  std::vector<char> transform_checked_, mesh_checked_, skin_checked_;
  std::vector<char> hidden_;  // itself or through an ancestor
  std::size_t primitives_ = 0, hidden_count_ = 0;
  std::string first_hidden_;
};

}  // namespace

Document check_document(const std::string& file, const Container& container, std::optional<int> scene_index) {
  const Parsed parsed(file, container.json);
  refuse_outputs_in(file, parsed.json());
  Document document;
  Item root(file, parsed.json(), "the document", &document.json);
  check_root(root);
  DocumentChecker(root, parsed, container, document).check(scene_index);
  return document;
}

}  // namespace palpa::geometry::gltf
