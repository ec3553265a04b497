// tinygltf reads documents that gltf_check has already reduced and proved: it meets no faults, no images, and no files
// but through the callbacks below. Its header is included here only.
#include "geometry/gltf.hpp"

#include <fmt/format.h>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <numeric>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf_accessor.hpp"
#include "geometry/gltf_buffers.hpp"
#include "geometry/gltf_check.hpp"
#include "geometry/gltf_container.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

// All instances together. A small file can ask for any number of them.
constexpr std::size_t most_triangles = 2'000'000, most_vertices = 6'000'000;

struct Source {
  const InputFile& file;
  const gltf::Container& container;
  const gltf::Document& document;
  std::optional<Error> fault;  // exceptions must not pass through tinygltf
};

// `path` is "buffer N" as gltf_check wrote it, or its stand-in "unused".
bool read_whole_file(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user) {
  Source& source = *static_cast<Source*>(user);
  out->assign(1, 0);
  const std::size_t digits = path.rfind(' ');
  if (digits == std::string::npos) return true;
  const std::size_t index = std::strtoull(path.c_str() + digits, nullptr, 10);
  try {
    *out = gltf::load_buffer(source.file, source.container.bin, index, source.document.buffers.at(index));
    return true;
  } catch (const Error& e) {
    source.fault = e;
    *error = e.what();
    return false;
  }
}

tinygltf::Model parse(const InputFile& file, const gltf::Container& container, const gltf::Document& document) {
  Source source{file, container, document, std::nullopt};
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks({[](const std::string&, void*) { return true; },
                         [](const std::string& path, void*) { return path; }, read_whole_file, nullptr, &source});
  reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const bool done = reader.LoadASCIIFromString(&model, &error, &warning, document.json.c_str(),
                                               static_cast<unsigned>(document.json.size()), "");
  if (source.fault) throw *source.fault;
  if (!done) throw bad_input(file.name(), "cannot be read as glTF: " + text::quoted(error));
  return model;
}

class SceneReader {
 public:
  SceneReader(const std::string& file, const tinygltf::Model& model) : model_(model) { scene_.file = file; }

  Scene read(const std::vector<std::uint32_t>& roots) {
    struct Visit {
      std::uint32_t node;
      Transform T_world_parent;
    };
    std::vector<Visit> stack;
    for (auto n = roots.rbegin(); n != roots.rend(); ++n)
      stack.push_back({*n, Transform(1)});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const tinygltf::Node& node = model_.nodes[visit.node];
      const Transform T_world_node = visit.T_world_parent * local_transform(node);
      if (node.mesh >= 0) add(visit.node, T_world_node);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
        stack.push_back({static_cast<std::uint32_t>(*child), T_world_node});
      }
    }
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const std::string& fault) const { throw bad_input(scene_.file, fault); }

  static Transform local_transform(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
    Transform T(1);
    if (node.rotation.size() == 4) {
      const auto& q = node.rotation;
      T = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
    }
    if (node.scale.size() == 3) {
      for (int i = 0; i < 3; ++i)
        T[i] *= node.scale[static_cast<std::size_t>(i)];
    }
    if (node.translation.size() == 3) T[3] = Vec4(node.translation[0], node.translation[1], node.translation[2], 1);
    return T;
  }

  void add(std::uint32_t n, const Transform& T_world_node) {
    const tinygltf::Node& node = model_.nodes[n];
    const Mesh& local = mesh(static_cast<std::uint32_t>(node.mesh));
    if (local.triangles.empty()) return;
    const double determinant = check_transform(n, T_world_node);
    triangles_ += local.triangles.size();
    vertices_ += local.positions.size();
    if (triangles_ > most_triangles || vertices_ > most_vertices) {
      fail(fmt::format("the scene has more than {} triangles or {} vertices, instances counted; palpa reads no more",
                       most_triangles, most_vertices));
    }
    const std::string& mesh_name = model_.meshes[static_cast<std::size_t>(node.mesh)].name;
    SceneMesh out{!node.name.empty() ? node.name : !mesh_name.empty() ? mesh_name : fmt::format("node {}", n), local};
    for (std::size_t v = 0; v < out.mesh.positions.size(); ++v) {
      Vec3& p = out.mesh.positions[v];
      p = transform_point(T_world_node, p);
      if (!finite(p)) fail(fmt::format("node {}: vertex {} is not finite in the world", n, v));
    }
    if (determinant < 0) flip(out.mesh);
    scene_.meshes.push_back(std::move(out));
  }

  static bool finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

  double check_transform(std::uint32_t n, const Transform& T) const {
    const Vec3 x(T[0]), y(T[1]), z(T[2]);
    if (!finite(x) || !finite(y) || !finite(z) || !finite(Vec3(T[3]))) {
      fail(fmt::format("node {}: its transform in the world is not finite", n));
    }
    // Of unit columns, so that small scales are not taken for none.
    const double lengths = glm::length(x) * glm::length(y) * glm::length(z);
    const double sine =
        lengths > 0 ? glm::dot(x / glm::length(x), glm::cross(y / glm::length(y), z / glm::length(z))) : 0;
    if (!(std::abs(sine) > 1e-9)) {
      fail(fmt::format("node {}: its scale is zero along some direction, which makes its mesh flat", n));
    }
    return sine;
  }

  // The mesh in its own coordinates; read once, however many nodes show it.
  const Mesh& mesh(std::uint32_t m) {
    const auto known = meshes_.find(m);
    if (known != meshes_.end()) return known->second;
    Mesh result;
    const auto& primitives = model_.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p)
      append(result, primitive(fmt::format("mesh {}", m), primitives[p]));
    return meshes_.emplace(m, std::move(result)).first->second;
  }

  Mesh primitive(const std::string& where, const tinygltf::Primitive& primitive) {
    Mesh result;
    const auto position = static_cast<std::size_t>(primitive.attributes.at("POSITION"));
    const std::size_t count = model_.accessors[position].count;
    const bool indexed = primitive.indices >= 0;
    const std::size_t corners = indexed ? model_.accessors[static_cast<std::size_t>(primitive.indices)].count : count;
    if (count > most_vertices || gltf::triangle_count(primitive.mode, corners) > most_triangles) {
      fail(fmt::format("{} has {} vertices and {} corners; palpa reads at most {} vertices and {} triangles", where,
                       count, corners, most_vertices, most_triangles));
    }
    result.positions = positions(position);
    std::vector<std::uint32_t> order(count);
    if (indexed) {
      order = indices(static_cast<std::size_t>(primitive.indices), count);
    } else {
      std::iota(order.begin(), order.end(), 0U);
    }
    if (corners < 3 || (primitive.mode == TINYGLTF_MODE_TRIANGLES && corners % 3 != 0)) {
      log::warning(fmt::format("{}: {} has {} corners, which do not make whole triangles; the rest is dropped",
                               scene_.file, where, corners));
    }
    result.triangles = gltf::triangles_of(primitive.mode, order);
    return result;
  }

  std::vector<Vec3> positions(std::size_t accessor) const {
    std::uint64_t fault = 0;
    auto values = gltf::read_vec3(column(accessor, 12), sparse(accessor, 12), fault);
    if (!values) fail_sparse(accessor, fault);
    for (std::size_t v = 0; v < values->size(); ++v) {
      const Vec3& p = (*values)[v];
      if (!finite(p)) fail(fmt::format("accessor {}: vertex {} is not finite: {}", accessor, v, text::point(p)));
    }
    return *std::move(values);
  }

  std::vector<std::uint32_t> indices(std::size_t accessor, std::size_t vertices) const {
    const int component = model_.accessors[accessor].componentType;
    const std::size_t size = component_size(component);
    std::uint64_t fault = 0;
    auto values = gltf::read_unsigned(column(accessor, size), sparse(accessor, size), fault);
    if (!values) fail_sparse(accessor, fault);
    const std::uint32_t restart = size == 4 ? 0xffffffffU : (1U << (8 * size)) - 1;
    for (std::size_t i = 0; i < values->size(); ++i) {
      const std::uint32_t index = (*values)[i];
      if (index == restart)
        fail(fmt::format("accessor {}: index {} is {}, a primitive restart, which glTF does not have", accessor, i,
                         index));
      if (index >= vertices) {
        fail(fmt::format("accessor {}: index {} names vertex {}, but there are only {}", accessor, i, index, vertices));
      }
    }
    return *std::move(values);
  }

  [[noreturn]] void fail_sparse(std::size_t accessor, std::uint64_t index) const {
    fail(fmt::format("accessor {}: the sparse index {} is out of range or not larger than the one before", accessor,
                     index));
  }

  static std::size_t component_size(int component) {
    return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component)));
  }

  gltf::Column column(int view_index, std::size_t offset, std::size_t count, std::size_t element, int component) const {
    if (view_index < 0) return {{}, count, element, component};
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
    const std::span<const unsigned char> bytes(model_.buffers[static_cast<std::size_t>(view.buffer)].data);
    return {bytes.subspan(view.byteOffset, view.byteLength).subspan(offset), count,
            view.byteStride == 0 ? element : view.byteStride, component};
  }
  gltf::Column column(std::size_t accessor, std::size_t element) const {
    const tinygltf::Accessor& a = model_.accessors[accessor];
    return column(a.bufferView, a.byteOffset, a.count, element, a.componentType);
  }
  std::optional<gltf::Sparse> sparse(std::size_t accessor, std::size_t element) const {
    const tinygltf::Accessor& a = model_.accessors[accessor];
    if (!a.sparse.isSparse) return std::nullopt;
    const auto count = static_cast<std::size_t>(a.sparse.count);
    const auto& indices = a.sparse.indices;
    const auto& values = a.sparse.values;
    return gltf::Sparse{
        column(indices.bufferView, static_cast<std::size_t>(indices.byteOffset), count,
               component_size(indices.componentType), indices.componentType),
        column(values.bufferView, static_cast<std::size_t>(values.byteOffset), count, element, a.componentType)};
  }

  const tinygltf::Model& model_;
  Scene scene_;
  std::map<std::uint32_t, Mesh> meshes_;
  std::size_t triangles_ = 0, vertices_ = 0;
};

}  // namespace

Scene load_gltf(const std::filesystem::path& path, std::optional<int> scene_index) {
  const InputFile file(path);
  gltf::Container container = gltf::read_container(file);
  gltf::Document document = gltf::check_document(file.name(), container, scene_index);
  container.json = {};
  const tinygltf::Model model = parse(file, container, document);
  return SceneReader(file.name(), model).read(document.roots);
}

}  // namespace palpa::geometry
