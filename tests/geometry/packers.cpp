#include "geometry/packers.hpp"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

namespace palpa::test {
namespace {

using geometry::Mesh;
using Json = GltfBuilder::Json;

template <typename T>
void put(std::vector<unsigned char>& bytes, T value) {
  const auto more = bytes_of(std::vector<T>{value});
  bytes.insert(bytes.end(), more.begin(), more.end());
}

struct Integers {
  double low, high;
};
Integers integers_of(int component) {
  constexpr Integers all[]{{-127, 127}, {0, 255}, {-32767, 32767}, {0, 65535}};
  return all[component - 5120];
}

int add_accessor(GltfBuilder& file, const Json& accessor) {
  file.doc["accessors"].push_back(accessor);
  return static_cast<int>(file.doc["accessors"].size()) - 1;
}

template <typename T>
void add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data, std::uint32_t id,
                   const std::vector<std::vector<T>>& rows) {
  draco::GeometryAttribute attribute;
  const std::size_t width = rows.front().size();
  attribute.Init(type, nullptr, static_cast<std::int8_t>(width), data, false,
                 static_cast<std::int64_t>(width * sizeof(T)), 0);
  const int index = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(rows.size()));
  for (std::uint32_t v = 0; v < rows.size(); ++v)
    mesh.attribute(index)->SetAttributeValue(draco::AttributeValueIndex(v), rows[v].data());
  mesh.attribute(index)->set_unique_id(id);
}

}  // namespace

Quantized quantized_file(const Mesh& mesh, int component, bool normalized) {
  const Box box = geometry::bounds(mesh);
  const Vec3 size = box.high - box.low;
  const auto [low, high] = integers_of(component);
  Quantized result;
  const double extent = std::max({size.x, size.y, size.z});
  result.step = extent / (high - low);
  std::vector<unsigned char> bytes;
  const auto integer = [&, low = low](double x) { return std::round(low + x / result.step); };
  for (const Vec3& p : mesh.positions) {
    for (int i = 0; i < 3; ++i) {
      const auto n = static_cast<std::int32_t>(integer(p[i] - box.low[i]));
      if (component < 5122) put(bytes, static_cast<std::uint8_t>(n));
      if (component >= 5122) put(bytes, static_cast<std::uint16_t>(n));
    }
    // Vertices are aligned to four bytes.
    while (bytes.size() % 4 != 0)
      bytes.push_back(0);
  }
  GltfBuilder& file = result.file;
  const int stride = component < 5122 ? 4 : 8;
  const auto bound = [&](const Vec3& p) {
    return Json{integer(p.x - box.low.x), integer(p.y - box.low.y), integer(p.z - box.low.z)};
  };
  const int positions = add_accessor(file, {{"bufferView", file.add_view(bytes, stride)},
                                            {"componentType", component},
                                            {"normalized", normalized},
                                            {"count", mesh.positions.size()},
                                            {"type", "VEC3"},
                                            {"min", bound(box.low)},
                                            {"max", bound(box.high)}});
  file.add_mesh(positions, file.add_indices(corners_of(mesh)));
  const double scale = normalized ? result.step * high : result.step;
  const double first = normalized ? std::round(low) / high : std::round(low);
  const Vec3 shift = box.low - scale * first;
  file.add_node({{"mesh", 0}, {"scale", {scale, scale, scale}}, {"translation", {shift.x, shift.y, shift.z}}});
  file.doc["extensionsUsed"] = {"KHR_mesh_quantization"};
  file.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
  return result;
}

std::vector<unsigned char> draco_stream(const Mesh& mesh, int bits, bool sequential, bool skin) {
  draco::Mesh out;
  out.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
  std::vector<std::vector<float>> positions, weights;
  std::vector<std::vector<std::uint16_t>> joints;
  for (const Vec3& p : mesh.positions) {
    positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    weights.push_back({0.25F, 0.25F, 0.25F, 0.25F});
    joints.push_back({1, 1, 1, 1});
  }
  add_attribute(out, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 7, positions);
  if (skin) {
    add_attribute(out, draco::GeometryAttribute::GENERIC, draco::DT_UINT16, 8, joints);
    add_attribute(out, draco::GeometryAttribute::GENERIC, draco::DT_FLOAT32, 9, weights);
  }
  for (const glm::uvec3& t : mesh.triangles)
    out.AddFace({{draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])}});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  if (bits > 0) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(out, &buffer).ok()) return {};
  return {buffer.data(), buffer.data() + buffer.size()};
}

GltfBuilder draco_file(const std::vector<unsigned char>& stream, std::size_t vertices, std::size_t triangles) {
  GltfBuilder file;
  const int view = file.add_view(stream);
  const int positions = add_accessor(file, {{"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}});
  const int indices = add_accessor(file, {{"componentType", 5125}, {"count", 3 * triangles}, {"type", "SCALAR"}});
  file.add_mesh(positions, indices);
  file.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 7}}}};
  file.add_node({{"mesh", 0}});
  file.doc["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  file.doc["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return file;
}

GltfBuilder meshopt_file(const Mesh& mesh, const MeshoptChoice& choice) {
  GltfBuilder file;
  std::uint64_t unpacked = 0;
  const auto add_packed = [&](const std::vector<unsigned char>& bytes, const Json& extension) {
    const int view = file.add_view(bytes);
    const auto length = extension["byteStride"].get<std::uint64_t>() * extension["count"].get<std::uint64_t>();
    Json& plain = file.doc["bufferViews"][static_cast<std::size_t>(view)];
    Json packed = extension;
    for (const char* key : {"buffer", "byteOffset", "byteLength"})
      packed[key] = plain[key];
    plain = {
        {"buffer", 1}, {"byteOffset", unpacked}, {"byteLength", length}, {"extensions", {{choice.extension, packed}}}};
    if (extension["mode"] == "ATTRIBUTES") plain["byteStride"] = extension["byteStride"];
    unpacked += length;
    return view;
  };

  std::vector<unsigned char> vertices;
  for (const Vec3& p : mesh.positions) {
    for (int i = 0; i < 3; ++i) {
      // The filter's numbers are 2^exponent * mantissa: 8 and 24 bits, both signed.
      const auto mantissa = static_cast<std::int32_t>(std::lround(p[i] * (1 << 20)));
      if (choice.exponential) put(vertices, static_cast<std::uint32_t>(-20) << 24 | (mantissa & 0xffffff));
      if (!choice.exponential) put(vertices, static_cast<float>(p[i]));
    }
  }
  const std::size_t count = mesh.positions.size();
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(count, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), vertices.data(), count, 12));
  Json how{{"byteStride", 12}, {"count", count}, {"mode", "ATTRIBUTES"}};
  if (choice.exponential) how["filter"] = "EXPONENTIAL";
  const int positions = add_accessor(
      file, {{"bufferView", add_packed(packed, how)}, {"componentType", 5126}, {"count", count}, {"type", "VEC3"}});

  const std::vector<std::uint32_t> corners = corners_of(mesh);
  if (choice.sequence) {
    packed.resize(meshopt_encodeIndexSequenceBound(corners.size(), count));
    packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), corners.data(), corners.size()));
  } else {
    packed.resize(meshopt_encodeIndexBufferBound(corners.size(), count));
    packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), corners.data(), corners.size()));
  }
  how = {{"byteStride", choice.index_size},
         {"count", corners.size()},
         {"mode", choice.sequence ? "INDICES" : "TRIANGLES"}};
  const int indices = add_accessor(file, {{"bufferView", add_packed(packed, how)},
                                          {"componentType", choice.index_size == 2 ? 5123 : 5125},
                                          {"count", corners.size()},
                                          {"type", "SCALAR"}});
  file.add_mesh(positions, indices);
  file.add_node({{"mesh", 0}});
  file.doc["buffers"] = Json::array({{{"byteLength", file.bin.size()}}, {{"byteLength", unpacked}}});
  if (choice.flagged) file.doc["buffers"][1]["extensions"] = {{choice.extension, {{"fallback", true}}}};
  file.doc["extensionsUsed"] = {choice.extension};
  file.doc["extensionsRequired"] = {choice.extension};
  return file;
}

bool same_triangles(const Mesh& a, const Mesh& b, double tolerance) {
  if (a.triangles.size() != b.triangles.size()) return false;
  std::vector<char> taken(b.triangles.size(), 0);
  const auto near = [&](const Vec3& p, const Vec3& q) {
    const Vec3 d = glm::abs(p - q);
    return std::max({d.x, d.y, d.z}) <= tolerance;
  };
  return std::all_of(a.triangles.begin(), a.triangles.end(), [&](const glm::uvec3& t) {
    for (std::size_t i = 0; i < b.triangles.size(); ++i) {
      const glm::uvec3& u = b.triangles[i];
      for (int turn = 0; turn < 3 && !taken[i]; ++turn) {
        bool all = true;
        for (int corner = 0; corner < 3; ++corner)
          all = all && near(a.positions[t[corner]], b.positions[u[(corner + turn) % 3]]);
        if (!all) continue;
        taken[i] = 1;
        return true;
      }
    }
    return false;
  });
}

}  // namespace palpa::test
