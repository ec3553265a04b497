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
#include "base/text.hpp"
#include "geometry/gltf/draco.hpp"
#include "geometry/gltf/model.hpp"
#include "geometry/gltf/values.hpp"
#include "geometry/gltf_document/container.hpp"
#include "geometry/gltf_document/document.hpp"
#include "geometry/gltf_document/extensions.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

// Limits for all instances together. A small file can request any number of them.
constexpr std::size_t most_triangles = 2'000'000, most_vertices = 6'000'000, most_displaced = 20'000'000;

// Identifies a decoded stream: its view, the promised vertices and triangles, the wanted attributes.
using StreamKey = std::tuple<int, std::size_t, std::size_t, std::vector<gltf::DracoAttribute>>;

// Four joints of each vertex and their weights. A primitive has one or more such sets.
struct Influence {
  std::vector<std::uint32_t> joints;  // 4 per vertex
  std::vector<double> weights;        // 4 per vertex
};

// The effect of a morph target: an accessor's values, times the weight, are added to the positions.
struct Displacement {
  int accessor;
  double weight;
};

// glTF 2.0 section 3.7.3: each position becomes the weighted mean of its images under the joints' matrices. Weights are
// normalised. Returns the first vertex whose weights have no positive sum or that names a joint without a matrix;
// nullopt if there is none.
std::optional<std::size_t> apply_skin(std::vector<Vec3>& positions, const std::vector<Influence>& influences,
                                      const std::vector<Transform>& T_world_bind) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    Vec3 sum(0);
    double total = 0;
    for (const Influence& influence : influences) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
        const double weight = influence.weights[i];
        // Joints with weight 0 may have any index.
        if (weight == 0) continue;
        if (!(weight > 0) || influence.joints[i] >= T_world_bind.size()) return v;
        sum += weight * transform_point(T_world_bind[influence.joints[i]], positions[v]);
        total += weight;
      }
    }
    if (!(total > 0)) return v;
    positions[v] = sum / total;
  }
  return std::nullopt;
}

class SceneReader {
 public:
  SceneReader(const std::string& file, const gltf::Document& document, const tinygltf::Model& model)
      : document_(document), model_(model), values_(file, model), T_world_(model.nodes.size()) {
    scene_.file = file;
  }

  Scene read() {
    for (const std::uint32_t n : document_.shown)
      add(n, model_.nodes[n]);
    if (vanished_count_ == 0) return std::move(scene_);
    scene_.hidden = first_is(first_vanished_, vanished_count_) + " hidden by a scale of zero along all axes";
    if (scene_.meshes.empty())
      fail("no mesh is left: " + scene_.hidden +
           "; give one that is to be touched, and the nodes above it, another scale");
    log::warning(fmt::format("{}: {} and left out", scene_.file, scene_.hidden));
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

  // Each node's transform is computed once, from the first known ancestor down.
  const Transform& world_transform(std::uint32_t n) {
    std::vector<std::uint32_t> chain;
    for (std::uint32_t i = n; i != gltf::Document::no_parent && !T_world_[i]; i = document_.parents[i])
      chain.push_back(i);
    for (auto i = chain.rbegin(); i != chain.rend(); ++i) {
      const std::uint32_t parent = document_.parents[*i];
      const Transform local = gltf::local_transform(model_.nodes[*i]);
      T_world_[*i] = parent == gltf::Document::no_parent ? local : *T_world_[parent] * local;
    }
    return *T_world_[n];
  }

  void add(std::uint32_t n, const tinygltf::Node& node) {
    const tinygltf::Value* instancing = gltf::find(node.extensions, gltf::instancing_extension);
    const tinygltf::Mesh& mesh = gltf::at(model_.meshes, node.mesh);
    if (!count(mesh, instancing == nullptr ? 1 : instance_count(*instancing))) return;
    const std::string name = !node.name.empty()   ? node.name
                             : !mesh.name.empty() ? mesh.name
                                                  : fmt::format("node {}", n);
    if (node.skin >= 0) {
      // The bones determine the position of a skinned mesh; its node's own transform has no effect (glTF 2.0, 3.7.3.3).
      const Bones& bones = bones_of(node.skin);
      SceneMesh out = begin(name, n, &bones);
      if (bones.mirrored) flip(out.mesh);
      finish(fmt::format("node {}", n), std::move(out));
      return;
    }
    const Transform& T_world_node = world_transform(n);
    if (instancing == nullptr) {
      place(fmt::format("node {}", n), name, n, T_world_node);
      return;
    }
    const std::vector<Transform> T_node_instance = read_instances(n, *instancing);
    for (std::size_t i = 0; i < T_node_instance.size(); ++i) {
      place(fmt::format("node {}, instance {}", n, i), fmt::format("{}[{}]", name, i), n,
            T_world_node * T_node_instance[i]);
    }
  }

  // The accessor of an attribute of instances; -1: none.
  static int attribute_of(const tinygltf::Value& instancing, const char* name) {
    const tinygltf::Value& attributes = instancing.Get("attributes");
    return attributes.Has(name) ? attributes.Get(name).GetNumberAsInt() : -1;
  }

  std::size_t instance_count(const tinygltf::Value& instancing) const {
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
      if (const int accessor = attribute_of(instancing, name); accessor >= 0)
        return gltf::at(model_.accessors, accessor).count;
    }
    return 0;
  }

  // Translation, rotation and scale of each instance, in the node's coordinates.
  std::vector<Transform> read_instances(std::uint32_t node, const tinygltf::Value& instancing) const {
    std::vector<Transform> T_node_instance(instance_count(instancing), Transform(1));
    const auto read = [&](const char* name, std::size_t width, const auto& put) {
      const int accessor = attribute_of(instancing, name);
      if (accessor < 0) return;
      const std::vector<double> all = values_.numbers(accessor);
      for (std::size_t i = 0; i < T_node_instance.size(); ++i) {
        const double* values = all.data() + i * width;
        if (!std::all_of(values, values + width, [](double x) { return std::isfinite(x); }))
          fail(fmt::format("node {}: instance {}: its place is not finite", node, i));
        put(i, values);
      }
    };
    read("ROTATION", 4, [&](std::size_t i, const double* q) {
      const glm::dquat turn(q[3], q[0], q[1], q[2]);
      const double norm = glm::dot(turn, turn);
      // Quantized rotations are slightly off.
      if (!(norm > 0.98 && norm < 1.02))
        fail(fmt::format("node {}: instance {}: its rotation is not a unit quaternion", node, i));
      T_node_instance[i] = glm::mat4_cast(glm::normalize(turn));
    });
    read("SCALE", 3, [&](std::size_t i, const double* s) {
      for (int k = 0; k < 3; ++k)
        T_node_instance[i][k] *= s[k];
    });
    read("TRANSLATION", 3, [&](std::size_t i, const double* t) { T_node_instance[i][3] = Vec4(t[0], t[1], t[2], 1); });
    return T_node_instance;
  }

  // The node's data with its mesh, in the mesh's own coordinates, or in the world's if it is on bones.
  SceneMesh begin(const std::string& name, std::uint32_t n, const Bones* bones) {
    SceneMesh out{name, {}, document_.haptics[n], document_.parts[n], std::nullopt};
    const std::vector<Transform>* T_world_bind = bones == nullptr ? nullptr : &bones->T_world_bind;
    const tinygltf::Node& node = model_.nodes[n];
    if (!node.weights.empty()) {
      out.mesh = build(node.mesh, node.weights, T_world_bind);
      return out;
    }
    const auto number = static_cast<std::uint32_t>(meshes_.size());
    const auto [known, fresh] = meshes_.try_emplace({node.mesh, node.skin});
    if (fresh) known->second = {build(node.mesh, {}, T_world_bind), number};
    out.mesh = known->second.mesh;
    out.copy = CopyOf{known->second.number, Transform(1)};
    return out;
  }

  // The mesh of node `n`, or an instance of it.
  void place(const std::string& where, const std::string& name, std::uint32_t n, const Transform& T_world_mesh) {
    // Exporters write hidden objects so.
    if (glm::dmat3(T_world_mesh) == glm::dmat3(0)) {
      if (vanished_count_++ == 0) first_vanished_ = where;
      return;
    }
    SceneMesh out = begin(name, n, nullptr);
    const bool mirrored = handedness(where, T_world_mesh) < 0;
    for (Vec3& p : out.mesh.positions)
      p = transform_point(T_world_mesh, p);
    if (mirrored) flip(out.mesh);
    if (out.copy) out.copy->T_world_mesh = T_world_mesh;
    finish(where, std::move(out));
  }

  void finish(const std::string& where, SceneMesh out) {
    for (std::size_t v = 0; v < out.mesh.positions.size(); ++v) {
      if (!is_finite(out.mesh.positions[v])) fail(fmt::format("{}: vertex {} is not finite in the world", where, v));
    }
    scene_.meshes.push_back(std::move(out));
  }

  // Adds `instances` of the mesh to the scene's size, before anything is allocated; false if it has no triangles.
  bool count(const tinygltf::Mesh& mesh, std::size_t instances) {
    bool any = false;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const std::size_t triangles = triangles_of(primitive);
      any = any || triangles > 0;
      // Both factors are below 2^32, and both sums are checked each time, so nothing overflows.
      triangles_ += triangles * instances;
      count_vertices(vertices_of(primitive) * instances);
    }
    return any;
  }

  // The numbers that the file promises. A draco stream may have others.
  std::size_t vertices_of(const tinygltf::Primitive& primitive) const {
    return gltf::at(model_.accessors, primitive.attributes.at("POSITION")).count;
  }
  std::size_t triangles_of(const tinygltf::Primitive& primitive) const {
    const std::size_t corners =
        primitive.indices < 0 ? vertices_of(primitive) : gltf::at(model_.accessors, primitive.indices).count;
    return gltf::triangle_count(primitive.mode, corners);
  }

  void count_vertices(std::size_t vertices) {
    vertices_ += vertices;
    if (triangles_ > most_triangles || vertices_ > most_vertices) {
      fail(fmt::format("the scene has more than {} triangles or {} vertices, instances counted; palpa reads no more",
                       most_triangles, most_vertices));
    }
  }

  // Negative for a mirroring transform. Throws for a degenerate one.
  double handedness(const std::string& where, const Transform& T) const {
    const Vec3 x(T[0]), y(T[1]), z(T[2]);
    if (!is_finite(x) || !is_finite(y) || !is_finite(z) || !is_finite(Vec3(T[3]))) {
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
    const auto [known, fresh] = bones_.try_emplace(s);
    Bones& bones = known->second;
    if (!fresh) return bones;
    const tinygltf::Skin& skin = gltf::at(model_.skins, s);
    log::debug(fmt::format("{}: skin {} of {} joints", scene_.file, s, skin.joints.size()));
    std::vector<double> inverse;
    // A file may have many skins that share many matrices.
    if (skin.inverseBindMatrices >= 0) inverse = values_.numbers(skin.inverseBindMatrices, skin.joints.size());
    bones.T_world_bind.reserve(skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      bones.T_world_bind.push_back(world_transform(static_cast<std::uint32_t>(skin.joints[j])));
      if (!inverse.empty()) bones.T_world_bind.back() *= glm::make_mat4(inverse.data() + 16 * j);
    }
    bones.mirrored = std::all_of(bones.T_world_bind.begin(), bones.T_world_bind.end(),
                                 [](const Transform& T) { return glm::determinant(glm::dmat3(T)) < 0; });
    return bones;
  }

  // All primitives together, morphed by the node's weights (else the mesh's), and moved by its bones, if any.
  Mesh build(int m, const std::vector<double>& weights, const std::vector<Transform>* T_world_bind) {
    const tinygltf::Mesh& mesh = gltf::at(model_.meshes, m);
    Mesh result;
    const std::string where = fmt::format("mesh {}", m);
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const std::optional<Unpacked> unpacked = unpack(where, primitive, T_world_bind != nullptr);
      Mesh piece;
      piece.positions = positions(primitive, unpacked);
      for (const auto& by : weights.empty() ? displacements_of(mesh, primitive) : displacements_of(primitive, weights))
        displace(piece.positions, by);
      if (T_world_bind != nullptr) put_on_bones(where, piece.positions, primitive, unpacked, *T_world_bind);
      piece.triangles = unpacked ? unpacked->mesh->triangles : triangles(where, primitive);
      if (mesh.primitives.size() == 1) return piece;
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
  std::optional<Unpacked> unpack(const std::string& mesh, const tinygltf::Primitive& primitive, bool with_bones) {
    const tinygltf::Value* stream = gltf::find(primitive.extensions, gltf::draco_extension);
    if (stream == nullptr) return std::nullopt;
    const int view = stream->Get("bufferView").GetNumberAsInt();
    Unpacked result;
    std::vector<gltf::DracoAttribute> wanted;
    for (const auto& [name, id] : stream->Get("attributes").Get<tinygltf::Value::Object>()) {
      const bool position = name == "POSITION";
      if (!primitive.attributes.contains(name) || !(position || with_bones)) continue;
      result.values.emplace(name, wanted.size());
      wanted.push_back({static_cast<std::uint32_t>(id.GetNumberAsInt()), position ? std::size_t{3} : std::size_t{4}});
    }
    const auto where = fmt::format("{}: the draco data in buffer view {}", mesh, view);
    const std::size_t vertices = vertices_of(primitive), triangles = triangles_of(primitive);
    auto& known = streams_[StreamKey(view, vertices, triangles, wanted)];
    const bool fresh = known == nullptr;
    if (fresh) {
      std::string fault;
      auto decoded = gltf::decode_draco(values_.bytes(view), wanted, vertices, triangles, spare_draco_bytes_, fault);
      if (!decoded) fail(fmt::format("{} {}", where, fault));
      if (decoded->points > vertices) count_vertices(decoded->points - vertices);
      known = std::make_shared<const gltf::DracoMesh>(*std::move(decoded));
    }
    result.mesh = known;
    const bool fewer_triangles = known->triangles.size() < triangles && primitive.mode == 4;
    if (known->points != vertices || fewer_triangles) {
      const std::string other = fmt::format("{} hold {} vertices and {} triangles where the file promises {} and {}",
                                            where, known->points, known->triangles.size(), vertices, triangles);
      // Data stored beside the stream must have the promised size.
      if (!primitive.targets.empty() || (with_bones && result.values.size() < primitive.attributes.size())) fail(other);
      if (fresh) log::warning(fmt::format("{}: {}", scene_.file, other));
    }
    return result;
  }

  std::vector<glm::uvec3> triangles(const std::string& where, const tinygltf::Primitive& primitive) const {
    std::vector<std::uint32_t> order;
    if (primitive.indices >= 0) {
      order = values_.indices(primitive.indices, vertices_of(primitive));
    } else {
      order.resize(vertices_of(primitive));
      std::iota(order.begin(), order.end(), 0U);
    }
    if (order.size() < 3 || (primitive.mode == 4 && order.size() % 3 != 0)) {
      log::warning(
          fmt::format("{}: {} has a primitive of {} corners, which do not make whole triangles; the rest is dropped",
                      scene_.file, where, order.size()));
    }
    return gltf::triangles_of(primitive.mode, order);
  }

  // The morph targets that the weights give an effect. `weights` may be empty, or has one for each target.
  static std::vector<Displacement> displacements_of(const tinygltf::Primitive& primitive,
                                                    const std::vector<double>& weights) {
    std::vector<Displacement> all;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      const auto accessor = primitive.targets[t].find("POSITION");
      if (weights[t] != 0 && accessor != primitive.targets[t].end()) all.push_back({accessor->second, weights[t]});
    }
    return all;
  }

  // By the mesh's own weights; found once, because many skins may share many targets.
  const std::vector<Displacement>& displacements_of(const tinygltf::Mesh& mesh, const tinygltf::Primitive& primitive) {
    const auto [known, fresh] = displacements_.try_emplace(&primitive);
    if (fresh) known->second = displacements_of(primitive, mesh.weights);
    return known->second;
  }

  void displace(std::vector<Vec3>& positions, const Displacement& displacement) {
    displaced_ += positions.size();
    if (displaced_ > most_displaced)
      fail(fmt::format("morph targets move more than {} vertices; palpa reads no more", most_displaced));
    const std::vector<double> by = values_.numbers(displacement.accessor);
    for (std::size_t v = 0; v < positions.size(); ++v)
      positions[v] += displacement.weight * Vec3(by[3 * v], by[3 * v + 1], by[3 * v + 2]);
  }

  void put_on_bones(const std::string& where, std::vector<Vec3>& positions, const tinygltf::Primitive& primitive,
                    const std::optional<Unpacked>& unpacked, const std::vector<Transform>& T_world_bind) const {
    std::vector<Influence> influences;
    for (int set = 0; set < 8; ++set) {
      const std::string joints = fmt::format("JOINTS_{}", set), weights = fmt::format("WEIGHTS_{}", set);
      if (!primitive.attributes.contains(joints) && !primitive.attributes.contains(weights)) break;
      if (!primitive.attributes.contains(joints) || !primitive.attributes.contains(weights))
        fail(fmt::format("{}: {} and {} go together; one is missing", where, joints, weights));
      Influence influence{{}, attribute(primitive, weights, unpacked)};
      for (const double joint : attribute(primitive, joints, unpacked)) {
        // A value that is not a number becomes a joint that no skin has.
        influence.joints.push_back(joint >= 0 && joint <= 65535 ? static_cast<std::uint32_t>(joint) : 0xffffffffU);
      }
      influences.push_back(std::move(influence));
    }
    if (influences.empty()) fail(fmt::format("{}: its node has a skin, but the mesh has no JOINTS_0", where));
    if (const auto vertex = apply_skin(positions, influences, T_world_bind)) {
      fail(fmt::format("{}: vertex {} has no positive weight, or names a joint that its skin does not have", where,
                       *vertex));
    }
  }

  // The numbers of every vertex, whether compressed or not.
  std::vector<double> attribute(const tinygltf::Primitive& primitive, const std::string& name,
                                const std::optional<Unpacked>& unpacked) const {
    const int accessor = primitive.attributes.at(name);
    if (!unpacked || !unpacked->values.contains(name)) return values_.numbers(accessor);
    return values_.normalized(accessor, unpacked->mesh->values[unpacked->values.at(name)]);
  }

  std::vector<Vec3> positions(const tinygltf::Primitive& primitive, const std::optional<Unpacked>& unpacked) const {
    const int accessor = primitive.attributes.at("POSITION");
    const std::vector<double> values = attribute(primitive, "POSITION", unpacked);
    std::vector<Vec3> result(values.size() / 3);
    Box box;
    for (std::size_t v = 0; v < result.size(); ++v) {
      result[v] = Vec3(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
      if (!is_finite(result[v]))
        fail(fmt::format("accessor {}: vertex {} is not finite: {}", accessor, v, text::point(result[v])));
      box.add(result[v]);
    }
    // draco rounds positions but leaves min and max unchanged.
    if (!unpacked) values_.check_bounds(accessor, box);
    return result;
  }

  const gltf::Document& document_;
  const tinygltf::Model& model_;
  const gltf::Values values_;
  std::vector<std::optional<Transform>> T_world_;  // of each node, as far as known
  Scene scene_;
  std::map<std::pair<int, int>, Shared> meshes_;  // by mesh and skin
  std::map<int, Bones> bones_;                    // by skin
  std::map<const tinygltf::Primitive*, std::vector<Displacement>> displacements_;
  std::map<StreamKey, std::shared_ptr<const gltf::DracoMesh>> streams_;
  std::uint64_t spare_draco_bytes_ = gltf::most_draco_bytes;
  std::size_t triangles_ = 0, vertices_ = 0, displaced_ = 0, vanished_count_ = 0;
  std::string first_vanished_;
};

}  // namespace

Scene load_gltf(const std::filesystem::path& path, std::optional<int> scene_index) {
  const InputFile file(path);
  gltf::Container container = gltf::read_container(file);
  gltf::Document document = gltf::check_document(file.name(), container, scene_index);
  container.json = {};
  const tinygltf::Model model = gltf::read_model(file, container, document);
  return SceneReader(file.name(), document, model).read();
}

Box box_of(const Scene& scene) {
  Box box;
  for (const SceneMesh& mesh : scene.meshes) {
    for (const Vec3& position : mesh.mesh.positions)
      box.add(position);
  }
  return box;
}

}  // namespace palpa::geometry
