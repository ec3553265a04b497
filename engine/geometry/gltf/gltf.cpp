#include "geometry/gltf/gltf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <memory>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf/accessor.hpp"
#include "geometry/gltf/draco.hpp"
#include "geometry/gltf/instances.hpp"
#include "geometry/gltf/model.hpp"
#include "geometry/gltf/skin.hpp"
#include "geometry/gltf/values.hpp"
#include "geometry/gltf_document/check.hpp"
#include "geometry/gltf_document/container.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

// Limits for all instances together. A small file can request any number of them.
constexpr std::size_t most_triangles = 2'000'000, most_vertices = 6'000'000, most_displaced = 20'000'000;

// Identifies a decoded stream: its view, the wanted attributes and the promised counts.
struct StreamKey {
  std::uint32_t view = 0;
  std::size_t vertices = 0, triangles = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> wanted{};  // attribute and width
  bool operator<(const StreamKey& other) const {
    return std::tie(view, vertices, triangles, wanted) <
           std::tie(other.view, other.vertices, other.triangles, other.wanted);
  }
};

class SceneReader {
 public:
  SceneReader(const std::string& file, const tinygltf::Model& model, const gltf::Document& document)
      : model_(model), document_(document), values_(file, model), T_world_(model.nodes.size()) {
    scene_.file = file;
  }

  Scene read() {
    std::vector<std::uint32_t> stack(document_.roots.rbegin(), document_.roots.rend());
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      const tinygltf::Node& node = model_.nodes[n];
      if (node.mesh >= 0) add(n, node);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
        stack.push_back(static_cast<std::uint32_t>(*child));
      }
    }
    return std::move(scene_);
  }

 private:
  struct Bones {
    std::vector<Transform> T_world_bind;
    bool mirrored = false;  // all of them
  };
  // A mesh in its own coordinates, or on its bones; read once, even if several nodes show it.
  struct Shared {
    Mesh mesh;
    std::uint32_t number;
  };

  [[noreturn]] void fail(const std::string& fault) const { throw bad_input(scene_.file, fault); }

  static Transform local_transform(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
    Transform T(1);
    if (node.rotation.size() == 4) {
      const auto& q = node.rotation;
      T = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
    }
    for (std::size_t i = 0; i < node.scale.size(); ++i)
      T[static_cast<int>(i)] *= node.scale[i];
    if (node.translation.size() == 3) T[3] = Vec4(node.translation[0], node.translation[1], node.translation[2], 1);
    return T;
  }

  // Each node's transform is computed once, from the first known ancestor down.
  const Transform& world_transform(std::uint32_t n) {
    std::vector<std::uint32_t> chain;
    for (std::uint32_t i = n; i != gltf::Document::no_parent && !T_world_[i]; i = document_.parents[i])
      chain.push_back(i);
    for (auto i = chain.rbegin(); i != chain.rend(); ++i) {
      const std::uint32_t parent = document_.parents[*i];
      const Transform local = local_transform(model_.nodes[*i]);
      T_world_[*i] = parent == gltf::Document::no_parent ? local : *T_world_[parent] * local;
    }
    return *T_world_[n];
  }

  void add(std::uint32_t n, const tinygltf::Node& node) {
    const auto m = static_cast<std::uint32_t>(node.mesh);
    const auto instancing = document_.instancing.find(n);
    const bool many = instancing != document_.instancing.end();
    if (!count(m, many ? instancing->second.count : 1)) return;
    const std::string& mesh_name = model_.meshes[m].name;
    const std::string name = !node.name.empty()   ? node.name
                             : !mesh_name.empty() ? mesh_name
                                                  : fmt::format("node {}", n);
    if (node.skin >= 0) {
      // The bones determine the position of a skinned mesh; its node's own transform has no effect (glTF 2.0, 3.7.3.3).
      const Bones& bones = bones_of(node.skin);
      SceneMesh out = begin(name, n, m, node, &bones);
      if (bones.mirrored) flip(out.mesh);
      finish(fmt::format("node {}", n), std::move(out));
      return;
    }
    const Transform& T_world_node = world_transform(n);
    if (!many) {
      place(fmt::format("node {}", n), T_world_node, begin(name, n, m, node, nullptr));
      return;
    }
    const std::vector<Transform> T_node_instance = gltf::read_instances(scene_.file, n, instancing->second, values_);
    for (std::size_t i = 0; i < T_node_instance.size(); ++i) {
      place(fmt::format("node {}, instance {}", n, i), T_world_node * T_node_instance[i],
            begin(fmt::format("{}[{}]", name, i), n, m, node, nullptr));
    }
  }

  // The node's data with its mesh, in the mesh's own coordinates, or in the world's if it is on bones.
  SceneMesh begin(std::string name, std::uint32_t n, std::uint32_t m, const tinygltf::Node& node, const Bones* bones) {
    SceneMesh out{std::move(name), {}, document_.haptics[n], document_.parts[n], std::nullopt};
    if (!node.weights.empty()) {
      out.mesh = build(m, node.weights, bones == nullptr ? nullptr : &bones->T_world_bind);
      return out;
    }
    const std::pair key(m, node.skin);
    auto known = meshes_.find(key);
    if (known == meshes_.end()) {
      Shared shared{build(m, {}, bones == nullptr ? nullptr : &bones->T_world_bind),
                    static_cast<std::uint32_t>(meshes_.size())};
      known = meshes_.emplace(key, std::move(shared)).first;
    }
    out.mesh = known->second.mesh;
    out.copy = CopyOf{known->second.number, Transform(1)};
    return out;
  }

  void place(const std::string& where, const Transform& T_world_mesh, SceneMesh out) {
    const bool mirrored = handedness(where, T_world_mesh) < 0;
    for (Vec3& p : out.mesh.positions)
      p = transform_point(T_world_mesh, p);
    if (mirrored) flip(out.mesh);
    if (out.copy) out.copy->T_world_mesh = T_world_mesh;
    finish(where, std::move(out));
  }

  void finish(const std::string& where, SceneMesh out) {
    for (std::size_t v = 0; v < out.mesh.positions.size(); ++v) {
      if (!finite(out.mesh.positions[v])) fail(fmt::format("{}: vertex {} is not finite in the world", where, v));
    }
    scene_.meshes.push_back(std::move(out));
  }

  // Adds `instances` of the mesh to the scene's size, before anything is allocated; false if it has no triangles.
  bool count(std::uint32_t m, std::size_t instances) {
    std::size_t triangles = 0, vertices = 0;
    const std::vector<tinygltf::Primitive>& primitives = model_.meshes[m].primitives;
    for (std::uint32_t p = 0; p < primitives.size(); ++p) {
      const auto [points, corners] = promised(primitives[p], stream_of(m, p));
      triangles += gltf::triangle_count(primitives[p].mode, corners);
      vertices += points;
    }
    triangles_ += triangles * instances;
    count_vertices(vertices * instances);
    return triangles > 0;
  }

  void count_vertices(std::size_t vertices) {
    vertices_ += vertices;
    if (triangles_ > most_triangles || vertices_ > most_vertices) {
      fail(fmt::format("the scene has more than {} triangles or {} vertices, instances counted; palpa reads no more",
                       most_triangles, most_vertices));
    }
  }

  static bool finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

  // Negative for a mirroring transform. Throws for a degenerate one.
  double handedness(const std::string& where, const Transform& T) const {
    const Vec3 x(T[0]), y(T[1]), z(T[2]);
    if (!finite(x) || !finite(y) || !finite(z) || !finite(Vec3(T[3]))) {
      fail(where + ": its transform in the world is not finite");
    }
    // Uses unit columns, so that small scales do not count as zero.
    const double lengths = glm::length(x) * glm::length(y) * glm::length(z);
    const double sine =
        lengths > 0 ? glm::dot(x / glm::length(x), glm::cross(y / glm::length(y), z / glm::length(z))) : 0;
    if (!(std::abs(sine) > 1e-9)) {
      fail(where + ": its scale is zero along some direction, which makes its mesh flat");
    }
    return sine;
  }

  // Computed once, even if several nodes use the skin.
  const Bones& bones_of(int s) {
    const auto known = bones_.find(s);
    if (known != bones_.end()) return known->second;
    const tinygltf::Skin& skin = model_.skins[static_cast<std::size_t>(s)];
    log::debug(fmt::format("{}: skin {} of {} joints", scene_.file, s, skin.joints.size()));
    std::vector<double> inverse;
    if (skin.inverseBindMatrices >= 0)
      inverse = values_.numbers(static_cast<std::size_t>(skin.inverseBindMatrices), 16);
    Bones bones;
    bones.T_world_bind.reserve(skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      bones.T_world_bind.push_back(world_transform(static_cast<std::uint32_t>(skin.joints[j])));
      if (!inverse.empty()) bones.T_world_bind.back() *= glm::make_mat4(inverse.data() + 16 * j);
    }
    bones.mirrored = std::all_of(bones.T_world_bind.begin(), bones.T_world_bind.end(),
                                 [](const Transform& T) { return glm::determinant(glm::dmat3(T)) < 0; });
    return bones_.emplace(s, std::move(bones)).first->second;
  }

  // All primitives together, morphed by the node's weights (else the mesh's), and moved by its bones, if any.
  Mesh build(std::uint32_t m, const std::vector<double>& node_weights, const std::vector<Transform>* T_world_bind) {
    const tinygltf::Mesh& mesh = model_.meshes[m];
    const std::vector<double>& weights = node_weights.empty() ? mesh.weights : node_weights;
    Mesh result;
    for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      const std::string where = fmt::format("mesh {}", m);
      const std::optional<Unpacked> unpacked = unpack(m, p, primitive, T_world_bind != nullptr);
      Mesh piece;
      piece.positions = positions(primitive, unpacked);
      for (std::size_t t = 0; t < weights.size() && t < primitive.targets.size(); ++t) {
        if (weights[t] != 0) displace(piece.positions, primitive.targets[t], weights[t]);
      }
      if (T_world_bind != nullptr) put_on_bones(where, piece.positions, primitive, unpacked, *T_world_bind);
      piece.triangles = unpacked ? unpacked->mesh->triangles : triangles(where, primitive, piece.positions.size());
      append(result, piece);
    }
    return result;
  }

  // A primitive decoded from a draco stream.
  struct Unpacked {
    std::shared_ptr<const gltf::DracoMesh> mesh;
    std::map<std::string, std::size_t> values;  // the attribute's index in mesh->values
  };

  // nullopt if the primitive is not compressed.
  std::optional<Unpacked> unpack(std::uint32_t m, std::uint32_t p, const tinygltf::Primitive& primitive,
                                 bool with_bones) {
    const gltf::DracoSource* source = stream_of(m, p);
    if (source == nullptr) return std::nullopt;
    Unpacked result;
    StreamKey key;
    for (const auto& [name, id] : source->attributes) {
      const bool position = name == "POSITION";
      if (!primitive.attributes.contains(name) || !(position || with_bones)) continue;
      result.values.emplace(name, key.wanted.size());
      key.wanted.emplace_back(id, position ? std::size_t{3} : std::size_t{4});
    }
    const auto where = fmt::format("mesh {}: the draco data in buffer view {}", m, source->view);
    const auto [vertices, corners] = promised(primitive, source);
    const std::size_t triangles = gltf::triangle_count(primitive.mode, corners);
    key.view = source->view;
    key.vertices = vertices;
    key.triangles = triangles;
    auto& known = streams_[key];
    const bool fresh = known == nullptr;
    if (fresh) known = decode(where, key);
    result.mesh = known;
    const bool fewer_triangles = known->triangles.size() < triangles && primitive.mode == TINYGLTF_MODE_TRIANGLES;
    if (known->points != vertices || fewer_triangles) {
      const std::string other = fmt::format("{} hold {} vertices and {} triangles where the file promises {} and {}",
                                            where, known->points, known->triangles.size(), vertices, triangles);
      // Data stored beside the stream must have the promised size.
      if (!primitive.targets.empty() || (with_bones && result.values.size() < primitive.attributes.size())) fail(other);
      if (fresh) log::warning(fmt::format("{}: {}", scene_.file, other));
    }
    return result;
  }

  std::shared_ptr<const gltf::DracoMesh> decode(const std::string& where, const StreamKey& key) {
    std::vector<gltf::DracoAttribute> wanted;
    for (const auto& [id, width] : key.wanted)
      wanted.push_back({id, width});
    const tinygltf::BufferView& view = model_.bufferViews[key.view];
    const std::span<const unsigned char> bytes(model_.buffers[static_cast<std::size_t>(view.buffer)].data);
    std::string fault;
    auto mesh = gltf::decode_draco(bytes.subspan(view.byteOffset, view.byteLength), wanted, key.vertices, key.triangles,
                                   spare_draco_bytes_, fault);
    if (!mesh) fail(fmt::format("{} {}", where, fault));
    if (mesh->points > key.vertices) count_vertices(mesh->points - key.vertices);
    return std::make_shared<const gltf::DracoMesh>(*std::move(mesh));
  }

  // nullptr if the primitive is not compressed.
  const gltf::DracoSource* stream_of(std::uint32_t m, std::uint32_t p) const {
    const auto found = std::lower_bound(
        document_.draco.begin(), document_.draco.end(), std::pair(m, p),
        [](const gltf::DracoSource& d, const auto& place) { return std::pair(d.mesh, d.primitive) < place; });
    return found == document_.draco.end() || found->mesh != m || found->primitive != p ? nullptr : &*found;
  }

  // The numbers of vertices and of triangle corners, according to the accessors.
  std::pair<std::size_t, std::size_t> promised(const tinygltf::Primitive& p, const gltf::DracoSource* stream) const {
    const std::size_t vertices = model_.accessors[static_cast<std::size_t>(p.attributes.at("POSITION"))].count;
    if (stream != nullptr) return {vertices, stream->corners};
    return {vertices, p.indices < 0 ? vertices : model_.accessors[static_cast<std::size_t>(p.indices)].count};
  }

  std::vector<glm::uvec3> triangles(const std::string& where, const tinygltf::Primitive& primitive,
                                    std::size_t vertices) const {
    std::vector<std::uint32_t> order(vertices);
    if (primitive.indices >= 0) {
      order = values_.indices(static_cast<std::size_t>(primitive.indices), vertices);
    } else {
      std::iota(order.begin(), order.end(), 0U);
    }
    if (order.size() < 3 || (primitive.mode == TINYGLTF_MODE_TRIANGLES && order.size() % 3 != 0)) {
      log::warning(
          fmt::format("{}: {} has a primitive of {} corners, which do not make whole triangles; the rest is dropped",
                      scene_.file, where, order.size()));
    }
    return gltf::triangles_of(primitive.mode, order);
  }

  void displace(std::vector<Vec3>& positions, const std::map<std::string, int>& target, double weight) {
    const auto found = target.find("POSITION");
    if (found == target.end()) return;
    displaced_ += positions.size();
    if (displaced_ > most_displaced)
      fail(fmt::format("morph targets move more than {} vertices; palpa reads no more", most_displaced));
    const std::vector<double> by = values_.numbers(static_cast<std::size_t>(found->second), 3);
    for (std::size_t v = 0; v < positions.size(); ++v)
      positions[v] += weight * Vec3(by[3 * v], by[3 * v + 1], by[3 * v + 2]);
  }

  void put_on_bones(const std::string& where, std::vector<Vec3>& positions, const tinygltf::Primitive& primitive,
                    const std::optional<Unpacked>& unpacked, const std::vector<Transform>& T_world_bind) const {
    std::vector<gltf::Influence> influences;
    for (int set = 0; set < 8; ++set) {
      const std::string joints = fmt::format("JOINTS_{}", set), weights = fmt::format("WEIGHTS_{}", set);
      if (!primitive.attributes.contains(joints) && !primitive.attributes.contains(weights)) break;
      if (!primitive.attributes.contains(joints) || !primitive.attributes.contains(weights))
        fail(fmt::format("{}: {} and {} go together; one is missing", where, joints, weights));
      gltf::Influence influence{{}, attribute(primitive, weights, 4, unpacked)};
      for (const double joint : attribute(primitive, joints, 4, unpacked)) {
        // A value that is not a number becomes a joint that no skin has.
        influence.joints.push_back(joint >= 0 && joint <= 65535 ? static_cast<std::uint32_t>(joint) : 0xffffffffU);
      }
      influences.push_back(std::move(influence));
    }
    if (influences.empty()) fail(fmt::format("{}: its node has a skin, but the mesh has no JOINTS_0", where));
    if (const auto vertex = gltf::apply_skin(positions, influences, T_world_bind)) {
      fail(fmt::format("{}: vertex {} has no positive weight, or names a joint that its skin does not have", where,
                       *vertex));
    }
  }

  // `width` numbers for every vertex, whether compressed or not.
  std::vector<double> attribute(const tinygltf::Primitive& primitive, const std::string& name, std::size_t width,
                                const std::optional<Unpacked>& unpacked) const {
    const auto accessor = static_cast<std::size_t>(primitive.attributes.at(name));
    const tinygltf::Accessor& a = model_.accessors[accessor];
    if (!unpacked || !unpacked->values.contains(name)) return values_.numbers(accessor, width);
    std::vector<double> values = unpacked->mesh->values[unpacked->values.at(name)];
    if (a.normalized) {
      for (double& value : values)
        value = gltf::normalized_value(value, a.componentType);
    }
    return values;
  }

  std::vector<Vec3> positions(const tinygltf::Primitive& primitive, const std::optional<Unpacked>& unpacked) const {
    const auto accessor = static_cast<std::size_t>(primitive.attributes.at("POSITION"));
    const std::vector<double> values = attribute(primitive, "POSITION", 3, unpacked);
    std::vector<Vec3> result(values.size() / 3);
    Box box;
    for (std::size_t v = 0; v < result.size(); ++v) {
      result[v] = Vec3(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
      if (!finite(result[v]))
        fail(fmt::format("accessor {}: vertex {} is not finite: {}", accessor, v, text::point(result[v])));
      box.add(result[v]);
    }
    // draco rounds positions but leaves min and max unchanged.
    if (!unpacked) check_bounds(accessor, box);
    return result;
  }

  void check_bounds(std::size_t accessor, const Box& box) const {
    const tinygltf::Accessor& a = model_.accessors[accessor];
    for (std::size_t i = 0; i < 3 && a.minValues.size() == 3 && a.maxValues.size() == 3; ++i) {
      const int axis = static_cast<int>(i);
      // The file states min and max of the stored values.
      const auto bound = [&](double value) {
        return a.normalized ? gltf::normalized_value(value, a.componentType) : value;
      };
      const double slack = 1e-6 * std::max(std::abs(box.low[axis]), std::abs(box.high[axis]));
      if (std::abs(bound(a.minValues[i]) - box.low[axis]) <= slack &&
          std::abs(bound(a.maxValues[i]) - box.high[axis]) <= slack)
        continue;
      log::warning(fmt::format("{}: accessor {}: its min and max do not match its positions", scene_.file, accessor));
      break;
    }
  }

  const tinygltf::Model& model_;
  const gltf::Document& document_;
  const gltf::Values values_;
  std::vector<std::optional<Transform>> T_world_;
  Scene scene_;
  std::map<std::pair<std::uint32_t, int>, Shared> meshes_;  // by mesh and skin
  std::map<int, Bones> bones_;                              // by skin
  std::map<StreamKey, std::shared_ptr<const gltf::DracoMesh>> streams_;
  std::uint64_t spare_draco_bytes_ = gltf::most_draco_bytes;
  std::size_t triangles_ = 0, vertices_ = 0, displaced_ = 0;
};

}  // namespace

Scene load_gltf(const std::filesystem::path& path, std::optional<int> scene_index) {
  const InputFile file(path);
  gltf::Container container = gltf::read_container(file);
  gltf::Document document = gltf::check_document(file.name(), container, scene_index);
  container.json = {};
  const tinygltf::Model model = gltf::parse_model(file, container, document);
  return SceneReader(file.name(), model, document).read();
}

}  // namespace palpa::geometry
