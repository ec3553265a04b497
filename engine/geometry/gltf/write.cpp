#include "geometry/gltf/write.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little endian");

// Values from the enumerations of the glTF specification.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

template <class T>
void append_value(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

void pad(std::string& bytes, char with) {
  while (bytes.size() % 4 != 0)
    bytes += with;
}

/// One mesh in the binary chunk: positions (view and accessor 2i), then indices (2i + 1).
struct Item {
  const SceneMesh* mesh;
  std::size_t positions = 0, indices = 0;  ///< the bytes at which they begin
  std::array<float, 3> least{}, most{};    ///< of positions

  // 65535 is the restart value of 16-bit indices, so the last usable index is 65534.
  bool has_short_indices() const { return mesh->mesh.positions.size() <= 65535; }
};

struct Node {
  std::string_view name;
  std::optional<std::size_t> mesh;
  std::vector<std::size_t> children;
  const Haptics* haptics = nullptr;
  const PartOf* part = nullptr;
};

/// A file under construction: the contents of its JSON, and its binary chunk.
struct Document {
  std::vector<Item> items;
  std::vector<Node> nodes;
  std::vector<std::size_t> roots;
  std::string binary;
};

void add_positions(Document& document, Item& item, const std::string& what) {
  item.positions = document.binary.size();
  item.least.fill(std::numeric_limits<float>::infinity());
  item.most.fill(-std::numeric_limits<float>::infinity());
  for (const Vec3& p : item.mesh->mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      const double value = p[axis];
      if (!(std::fabs(value) <= std::numeric_limits<float>::max()))
        throw failure(what + " has a coordinate that a 32-bit float cannot hold");
      const float stored = static_cast<float>(value) + 0.0F;  // + 0 makes a negative zero positive
      item.least[axis] = std::min(item.least[axis], stored);
      item.most[axis] = std::max(item.most[axis], stored);
      append_value(document.binary, stored);
    }
  }
}

void add_indices(Document& document, Item& item, const std::string& what) {
  item.indices = document.binary.size();
  for (const glm::uvec3& triangle : item.mesh->mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = triangle[corner];
      if (index >= item.mesh->mesh.positions.size()) throw failure(what + " has an index out of range");
      if (item.has_short_indices())
        append_value(document.binary, static_cast<std::uint16_t>(index));
      else
        append_value(document.binary, index);
    }
  }
  pad(document.binary, '\0');
}

/// Returns the index of the node.
std::size_t add_node(Document& document, Node node) {
  document.nodes.push_back(std::move(node));
  return document.nodes.size() - 1;
}

/// Returns the index of its node.
std::size_t add_mesh(Document& document, const SceneMesh& mesh, const std::filesystem::path& file) {
  const std::string what = file.string() + ": mesh " + text::quoted(mesh.name);
  if (mesh.mesh.triangles.empty()) throw failure(what + " has no triangles to write");
  Item item{&mesh};
  add_positions(document, item, what);
  add_indices(document, item, what);
  document.items.push_back(item);
  const PartOf* part = mesh.part ? &*mesh.part : nullptr;
  return add_node(document, {mesh.name, document.items.size() - 1, {}, part ? nullptr : &mesh.haptics, part});
}

/// Adds the parts of one solid as children of a node that has the solid's name and haptics.
void add_parts(Document& document, std::span<const SceneMesh> parts, const std::filesystem::path& file) {
  std::vector<std::size_t> children;
  for (const SceneMesh& part : parts)
    children.push_back(add_mesh(document, part, file));
  const SceneMesh& first = parts.front();
  document.roots.push_back(add_node(document, {first.part->solid, {}, std::move(children), &first.haptics, nullptr}));
}

void write_click(JsonWriter& json, const Click& click) {
  json.key("click");
  if (click == Click{} || click.burst_s == 0) {
    json.value(click.burst_s > 0);
  } else {
    json.begin_array().value(click.burst_s).value(click.hz).end_array();
  }
}

/// Writes a node's `extras` as load_gltf() reads them; nothing if there are none.
void write_extras(JsonWriter& json, const Node& node) {
  if (node.haptics && *node.haptics == Haptics{}) return;
  json.key("extras").begin_object().key("palpa").begin_object();
  if (node.part) json.member("part_of", node.part->solid).member("seam_m", node.part->seam_m);
  if (node.haptics) {
    const Haptics& haptics = *node.haptics;
    const auto add = [&](const char* key, const auto& value) {
      if (value) json.member(key, *value);
    };
    if (!haptics.touchable) json.member("touchable", false);
    add("delta_m", haptics.delta_m);
    add("foci", haptics.foci);
    add("stride", haptics.stride);
    add("dwell_s", haptics.dwell_s);
    add("intensity", haptics.intensity);
    add("pressure_pa", haptics.pressure_pa);
    add("press_depth_m", haptics.press_depth_m);
    if (haptics.click) write_click(json, *haptics.click);
    if (haptics.stiffness) {
      json.key("stiffness").begin_array();
      for (const DepthForce& row : *haptics.stiffness)
        json.value(row.depth_m).value(row.force);
      json.end_array();
    }
    if (haptics.texture) json.member("texture", std::span<const double>(*haptics.texture));
    add("grain_m", haptics.grain_m);
  }
  json.end_object().end_object();
}

void write_node(JsonWriter& json, const Node& node) {
  json.begin_object().member("name", node.name);
  if (node.mesh) json.member("mesh", *node.mesh);
  if (!node.children.empty()) json.member("children", node.children);
  write_extras(json, node);
  json.end_object();
}

/// Neighbours in the list get very different colours: hues step by the golden ratio.
void write_material(JsonWriter& json, std::size_t index) {
  const double hue = std::fmod(static_cast<double>(index) * 0.618033988749895, 1.0) * 6;
  json.begin_object().key("pbrMetallicRoughness").begin_object().key("baseColorFactor").begin_array();
  for (const double at : {5.0, 3.0, 1.0}) {
    const double k = std::fmod(at + hue, 6.0);
    json.value(static_cast<float>(0.85 - 0.6 * std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
  }
  json.value(1).end_array().member("metallicFactor", 0).member("roughnessFactor", 0.7).end_object().end_object();
}

void write_accessors(JsonWriter& json, const std::vector<Item>& items) {
  json.key("accessors").begin_array();
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Mesh& mesh = items[i].mesh->mesh;
    const auto begin = [&](std::size_t view, int component, std::size_t count, const char* type) {
      json.begin_object().member("bufferView", view).member("componentType", component);
      json.member("count", count).member("type", type);
    };
    begin(2 * i, kFloat, mesh.positions.size(), "VEC3");
    json.member("min", std::span<const float>(items[i].least)).member("max", std::span<const float>(items[i].most));
    json.end_object();
    begin(2 * i + 1, items[i].has_short_indices() ? kUnsignedShort : kUnsignedInt, 3 * mesh.triangles.size(), "SCALAR");
    json.end_object();
  }
  json.end_array();
}

void write_views(JsonWriter& json, const std::vector<Item>& items) {
  const auto write = [&](std::size_t begin, std::size_t bytes, int target) {
    json.begin_object().member("buffer", 0).member("byteOffset", begin).member("byteLength", bytes);
    json.member("target", target).end_object();
  };
  json.key("bufferViews").begin_array();
  for (const Item& item : items) {
    write(item.positions, item.indices - item.positions, kArrayBuffer);
    write(item.indices, 3 * item.mesh->mesh.triangles.size() * (item.has_short_indices() ? 2 : 4), kElementArrayBuffer);
  }
  json.end_array();
}

/// Returns the number of materials used.
std::size_t write_meshes(JsonWriter& json, const std::vector<Item>& items) {
  std::size_t materials = 0;
  json.key("meshes").begin_array();
  for (std::size_t i = 0; i < items.size(); ++i) {
    json.begin_object().member("name", items[i].mesh->name).key("primitives").begin_array().begin_object();
    json.key("attributes").begin_object().member("POSITION", 2 * i).end_object().member("indices", 2 * i + 1);
    if (items[i].mesh->part) json.member("material", materials++);
    json.end_object().end_array().end_object();
  }
  json.end_array();
  return materials;
}

std::string json_of(const Document& document) {
  JsonWriter json;
  json.begin_object(JsonWriter::Style::compact);
  json.key("asset").begin_object().member("version", "2.0").member("generator", "palpa").end_object();
  json.member("scene", 0).key("scenes").begin_array().begin_object();
  if (document.items.empty()) {
    json.end_object().end_array().end_object();
    return json.take();
  }
  json.member("nodes", document.roots).end_object().end_array();
  json.key("nodes").begin_array();
  for (const Node& node : document.nodes)
    write_node(json, node);
  json.end_array();
  if (const std::size_t materials = write_meshes(json, document.items); materials > 0) {
    json.key("materials").begin_array();
    for (std::size_t i = 0; i < materials; ++i)
      write_material(json, i);
    json.end_array();
  }
  write_accessors(json, document.items);
  write_views(json, document.items);
  json.key("buffers").begin_array().begin_object();
  json.member("byteLength", document.binary.size()).end_object().end_array().end_object();
  return json.take();
}

}  // namespace

void write_glb(const std::filesystem::path& file, std::span<const SceneMesh> meshes) {
  Document document;
  for (std::size_t i = 0; i < meshes.size();) {
    if (!meshes[i].part) {
      document.roots.push_back(add_mesh(document, meshes[i], file));
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < meshes.size() && meshes[end].part && meshes[end].part->solid == meshes[i].part->solid &&
           meshes[end].part->group == meshes[i].part->group)
      ++end;
    add_parts(document, meshes.subspan(i, end - i), file);
    i = end;
  }
  std::string text = json_of(document);
  text.pop_back();  // the line break
  pad(text, ' ');

  const bool has_binary = !document.binary.empty();
  const std::uint64_t size = 12 + 8 + text.size() + (has_binary ? 8 + document.binary.size() : 0);
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw failure(file.string() + ": more than 4 GiB do not fit into a .glb file");
  std::string bytes;
  bytes.reserve(size);
  const auto append_words = [&](std::initializer_list<std::uint64_t> words) {
    for (const std::uint64_t word : words)
      append_value(bytes, static_cast<std::uint32_t>(word));
  };
  append_words({kMagic, kVersion, size, text.size(), kJsonChunk});
  bytes += text;
  if (has_binary) {
    append_words({document.binary.size(), kBinChunk});
    bytes += document.binary;
  }
  write_file(file, bytes);
}

}  // namespace palpa::geometry
