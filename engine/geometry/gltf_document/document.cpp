#include "geometry/gltf_document/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <string_view>
#include <tuple>
#include <utility>

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

// Maximum number of nodes, meshes, primitives, accessors and the like: each needs up to a kilobyte.
constexpr std::size_t most_items = 50'000;

// The files that a model refers to belong to it, whether palpa reads them or not.
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

// From the node's coordinates to its parent's.
Transform read_transform(const Item& node) {
  if (const auto matrix = node.numbers("matrix", 16)) {
    if (node.has("translation") || node.has("rotation") || node.has("scale")) {
      node.fail("has both \"matrix\" and translation, rotation or scale; it may have only one of the two");
    }
    const auto& m = *matrix;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      node.fail("\"matrix\" is not affine: its last row is not 0 0 0 1");
    return glm::make_mat4(m.data());
  }
  const auto t = node.numbers("translation", 3), s = node.numbers("scale", 3), r = node.numbers("rotation", 4);
  Transform T(1);
  if (r) {
    const auto& q = *r;
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm > 0.98 && norm < 1.02)) node.fail("\"rotation\" is not a unit quaternion");
    T = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  }
  for (int i = 0; s && i < 3; ++i)
    T[i] *= (*s)[static_cast<std::size_t>(i)];
  if (t) T[3] = Vec4((*t)[0], (*t)[1], (*t)[2], 1);
  return T;
}

// KHR_node_visibility of the node itself.
bool is_hidden(const Item& node) {
  if (!node.has_extension(visibility_extension)) return false;
  const Item item = node.needed_item("extensions").needed_item(visibility_extension);
  const auto visible = item.json().find("visible");
  if (visible == item.json().end()) return false;
  if (!visible->is_boolean()) item.fail("\"visible\" is neither true nor false");
  return !visible->get<bool>();
}

class DocumentReader {
 public:
  DocumentReader(const Item& root, const Parsed& parsed, const Container& container)
      : file_(root.file()), parsed_(parsed), root_(root), data_(root, parsed, container, document_) {
    document_.nodes.resize(root.size("nodes"));
    document_.meshes.resize(root.size("meshes"));
    document_.skins.resize(root.size("skins"));
    children_.resize(nodes().size());
    placed_.resize(nodes().size());
    hidden_.resize(nodes().size());
    mesh_read_.resize(document_.meshes.size());
    skin_read_.resize(document_.skins.size());
  }

  Document read(std::optional<int> scene_index) {
    read_tree();
    walk(choose_scene(scene_index));
    warn_of_unknown_keys();
    warn_of_hidden();
    Document document = document_;  // without what the following check reads
    if (const std::string fault = fault_elsewhere(); !fault.empty()) {
      if (document.shown.empty()) throw bad_input(file_, fault);
      log::warning(file_ + ": " + fault + " (the scene does not need it)");
    }
    return document;
  }

 private:
  Item at(const char* key, const char* name, std::size_t index) const { return root_.element(key, name, index); }
  std::vector<Node>& nodes() { return document_.nodes; }

  // Each node has at most one parent, and there are no loops: a forest.
  void read_tree() {
    for (std::uint32_t n = 0; n < nodes().size(); ++n) {
      const Item node = at("nodes", "node", n);
      children_[n] = node.indices("children", "node", nodes().size());
      for (const std::uint32_t child : children_[n]) {
        std::uint32_t& parent = nodes()[child].parent;
        if (child == n) node.fail("is its own child");
        if (parent != Node::none) {
          throw bad_input(
              file_, fmt::format("node {} is a child of both node {} and node {}; the nodes of glTF form trees", child,
                                 parent, n));
        }
        parent = n;
      }
    }
    std::vector<std::uint32_t> stack = roots();
    std::vector<char> seen(nodes().size(), 0);
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

  std::vector<std::uint32_t> roots() {
    std::vector<std::uint32_t> found;
    for (std::uint32_t n = 0; n < nodes().size(); ++n) {
      if (nodes()[n].parent == Node::none) found.push_back(n);
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
    std::vector<std::uint32_t> chosen = scene.indices("nodes", "node", nodes().size());
    for (const std::uint32_t n : chosen) {
      const std::uint32_t parent = nodes()[n].parent;
      if (parent != Node::none)
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
      read_node(n);
    }
  }

  void read_node(std::uint32_t n) {
    const Item item = at("nodes", "node", n);
    Node& node = nodes()[n];
    const bool is_root = node.parent == Node::none;
    place(n);
    const NodeHaptics extras = read_extras(item, unknown_keys_);
    node.haptics = inherit(item, extras, is_root ? Haptics{} : nodes()[node.parent].haptics);
    if (extras.part_of) node.part = PartOf{*extras.part_of, node.parent, extras.seam_m.value_or(0)};
    hidden_[n] = is_hidden(item) || (!is_root && hidden_[node.parent] != 0) ? 1 : 0;
    node.name = name_of(item);
    node.mesh = item.index("mesh", "mesh", document_.meshes.size());
    if (!node.mesh) return;
    document_.shown.push_back(n);
    if (hidden_[n] != 0 && hidden_count_++ == 0) first_hidden_ = item.where();
    node.weights = weights_of(item, read_mesh(*node.mesh));
    node.skin = item.index("skin", "skin", document_.skins.size());
    if (node.skin) read_skin(*node.skin);
    if (!item.has_extension(instancing_extension)) return;
    if (!node.skin) {
      node.instancing = read_instancing(item);
    } else {
      log::warning(fmt::format("{}: {}: {} has no effect on a skinned node, whose bones place its mesh", file_,
                               item.where(), instancing_extension));
    }
  }

  std::string name_of(const Item& item) const { return parsed_.whole_name(item.string("name").value_or("")); }

  static std::vector<double> weights_of(const Item& item, std::size_t targets) {
    return item.size("weights") == 0 ? std::vector<double>{} : item.numbers("weights", targets).value();
  }

  // Reads the transforms of the node and of its ancestors.
  void place(std::uint32_t n) {
    std::vector<std::uint32_t> chain;
    for (; n != Node::none && placed_[n] == 0; n = nodes()[n].parent) {
      placed_[n] = 1;
      nodes()[n].T_world_node = read_transform(at("nodes", "node", n));
      chain.push_back(n);
    }
    for (auto i = chain.rbegin(); i != chain.rend(); ++i) {
      Node& node = nodes()[*i];
      if (node.parent != Node::none) node.T_world_node = nodes()[node.parent].T_world_node * node.T_world_node;
    }
  }

  Instancing read_instancing(const Item& node) {
    const Item attributes = node.needed_item("extensions").needed_item(instancing_extension).needed_item("attributes");
    Instancing found;
    for (const auto& [name, role, into] :
         {std::tuple("TRANSLATION", Role::place, &found.translation),
          std::tuple("ROTATION", Role::rotation, &found.rotation), std::tuple("SCALE", Role::place, &found.scale)}) {
      *into = data_.named(attributes, name);
      if (!*into) continue;
      const std::uint64_t count = data_.read(**into, role);
      if (found.count != 0 && count != found.count)
        attributes.fail(fmt::format("has {} instances, but {} of {}", found.count, count, name));
      found.count = count;
    }
    if (found.count == 0) attributes.fail("has neither TRANSLATION nor ROTATION nor SCALE");
    return found;
  }

  void read_skin(std::uint32_t s) {
    if (skin_read_[s]) return;
    skin_read_[s] = 1;
    const Item item = at("skins", "skin", s);
    Skin& skin = document_.skins[s];
    skin.joints = item.indices("joints", "node", nodes().size());
    if (skin.joints.empty()) item.fail("has no joints");
    for (const std::uint32_t n : skin.joints)
      place(n);
    skin.inverse_bind_matrices = data_.named(item, "inverseBindMatrices");
    if (!skin.inverse_bind_matrices) return;
    const std::uint64_t count = data_.read(*skin.inverse_bind_matrices, Role::bind_matrices);
    if (count < skin.joints.size())
      item.fail(fmt::format("has {} joints but only {} inverse bind matrices", skin.joints.size(), count));
  }

  // Returns the number of its morph targets.
  std::size_t read_mesh(std::uint32_t m) {
    const Item item = at("meshes", "mesh", m);
    const std::size_t primitives = item.size("primitives");
    if (primitives == 0) item.fail("has no primitives");
    const std::string name = item.where() + ", primitive";
    const std::size_t targets = item.element("primitives", name, 0).size("targets");
    if (mesh_read_[m]) return targets;
    mesh_read_[m] = 1;
    MeshSource& mesh = document_.meshes[m];
    mesh.name = name_of(item);
    if (has_palpa_extras(item)) {
      log::warning(fmt::format("{}: {}: {}", file_, item.where(), extras_belong_to_nodes));
    }
    const std::vector<double> weights = weights_of(item, targets);
    primitives_ += primitives;
    if (primitives_ > most_items)
      throw bad_input(file_, fmt::format("has more than {} primitives; palpa reads no more", most_items));
    for (std::size_t p = 0; p < primitives; ++p) {
      auto primitive = read_primitive(item.element("primitives", name, p), targets);
      if (!primitive) continue;
      primitive->displacements = displacements_of(*primitive, weights);
      mesh.primitives.push_back(*std::move(primitive));
    }
    return targets;
  }

  // nullopt for points, lines and primitives without positions.
  std::optional<Primitive> read_primitive(const Item& item, std::size_t targets) {
    Primitive primitive;
    primitive.mode = static_cast<int>(item.whole("mode", 0, 6).value_or(4));
    const Item attributes = item.needed_item("attributes");
    const auto position = data_.named(attributes, "POSITION");
    if (primitive.mode < 4) return std::nullopt;
    if (!position) {
      log::warning(fmt::format("{}: {} has no POSITION and is left out", file_, item.where()));
      return std::nullopt;
    }
    const auto indices = data_.named(item, "indices");
    // An uncompressed copy, if there is one, is more exact.
    if (item.has_extension(draco_extension) && !(data_.has_data(*position) && (!indices || data_.has_data(*indices))))
      primitive.stream = data_.read_stream(item.needed_item("extensions").needed_item(draco_extension));
    const auto read_attribute = [&](const std::string& name, Role role) {
      const auto accessor = data_.named(attributes, name.c_str());
      if (!accessor) return;
      const std::uint64_t count = primitive.stream && primitive.stream->attributes.contains(name)
                                      ? data_.read_compressed(*accessor, role)
                                      : data_.read(*accessor, role);
      if (primitive.attributes.empty()) primitive.vertices = count;
      check_count(item, primitive, name, count);
      primitive.attributes.emplace(name, *accessor);
    };
    read_attribute("POSITION", Role::position);
    primitive.corners = !indices           ? primitive.vertices
                        : primitive.stream ? data_.read_compressed(*indices, Role::indices)
                                           : data_.read(*indices, Role::indices);
    if (!primitive.stream) primitive.indices = indices;
    for (int set = 0; set < 8; ++set) {
      read_attribute(fmt::format("JOINTS_{}", set), Role::joints);
      read_attribute(fmt::format("WEIGHTS_{}", set), Role::weights);
    }
    if (item.size("targets") != targets) {
      item.fail(fmt::format("has {} morph targets, but the mesh's first primitive has {}",
                            item.has("targets") ? fmt::to_string(item.size("targets")) : "no", targets));
    }
    for (std::size_t t = 0; t < targets; ++t) {
      const Item target = item.element("targets", item.where() + ", target", t);
      primitive.targets.push_back(data_.named(target, "POSITION"));
      if (const auto& accessor = primitive.targets.back())
        check_count(target, primitive, "POSITION", data_.read(*accessor, Role::displacement));
    }
    return primitive;
  }

  static void check_count(const Item& item, const Primitive& primitive, const std::string& what, std::uint64_t count) {
    if (count != primitive.vertices)
      item.fail(fmt::format("has {} positions but {} of {}", primitive.vertices, count, what));
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
      for (std::uint32_t i = 0; i < nodes().size(); ++i) {
        const Item node = at("nodes", "node", i);
        node.index("mesh", "mesh", document_.meshes.size());
        read_transform(node);
      }
      for (std::uint32_t i = 0; i < document_.meshes.size(); ++i)
        read_mesh(i);
      for (std::uint32_t i = 0; i < document_.skins.size(); ++i)
        read_skin(i);
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
  const Item& root_;
  Document document_;
  DataReader data_;
  std::vector<std::vector<std::uint32_t>> children_;
  UnknownKeys unknown_keys_;
  std::vector<char> placed_, mesh_read_, skin_read_;
  std::vector<char> hidden_;  // itself or through an ancestor
  std::size_t primitives_ = 0, hidden_count_ = 0;
  std::string first_hidden_;
};

}  // namespace

std::vector<Displacement> displacements_of(const Primitive& primitive, const std::vector<double>& weights) {
  std::vector<Displacement> all;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] != 0 && primitive.targets[t]) all.push_back({*primitive.targets[t], weights[t]});
  }
  return all;
}

Document read_document(const std::string& file, const Container& container, std::optional<int> scene_index) {
  const Parsed parsed(file, container.json);
  refuse_outputs_in(file, parsed.json());
  const Item root(file, parsed.json(), "the document");
  check_root(root);
  return DocumentReader(root, parsed, container).read(scene_index);
}

}  // namespace palpa::geometry::gltf
