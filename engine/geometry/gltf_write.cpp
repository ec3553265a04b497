#include "geometry/gltf_write.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/error.hpp"

namespace palpa::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little endian");

// Values of the glTF specification's enumerations.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

template <class T>
std::string number(T value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(c));
      out += escape.data();
    } else {
      out += c;
    }
  }
  return out + '"';
}

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

/// The JSON arrays of a file under construction, without their brackets, and its binary chunk.
struct Document {
  std::string nodes, roots, meshes, materials, accessors, views, binary;
  std::size_t count = 0;  ///< meshes so far; each has two views and two accessors
  std::size_t node_count = 0, material_count = 0;
};

void add_item(std::string& array, const std::string& item) {
  if (!array.empty()) array += ',';
  array += item;
}

/// Returns its index.
std::size_t add_node(Document& document, const std::string& members) {
  add_item(document.nodes, '{' + members + '}');
  return document.node_count++;
}

void add_view(Document& document, std::size_t begin, int target) {
  if (!document.views.empty()) document.views += ',';
  document.views += "{\"buffer\":0,\"byteOffset\":" + std::to_string(begin) +
                    ",\"byteLength\":" + std::to_string(document.binary.size() - begin) +
                    ",\"target\":" + std::to_string(target) + '}';
  pad(document.binary, '\0');
}

void add_positions(Document& document, const Mesh& mesh, const std::string& what) {
  const std::size_t begin = document.binary.size();
  std::array<float, 3> low{}, high{};
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (const Vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      const double value = p[axis];
      if (!(std::fabs(value) <= std::numeric_limits<float>::max()))
        throw failure(what + " has a coordinate that a 32-bit float cannot hold");
      const float stored = static_cast<float>(value) + 0.0F;  // + 0 makes a negative zero positive
      low[axis] = std::min(low[axis], stored);
      high[axis] = std::max(high[axis], stored);
      append_value(document.binary, stored);
    }
  }
  add_view(document, begin, kArrayBuffer);
  const auto triple = [](const std::array<float, 3>& v) {
    return '[' + number(v[0]) + ',' + number(v[1]) + ',' + number(v[2]) + ']';
  };
  if (!document.accessors.empty()) document.accessors += ',';
  document.accessors += "{\"bufferView\":" + std::to_string(2 * document.count) +
                        ",\"componentType\":" + std::to_string(kFloat) +
                        ",\"count\":" + std::to_string(mesh.positions.size()) +
                        ",\"type\":\"VEC3\",\"min\":" + triple(low) + ",\"max\":" + triple(high) + '}';
}

void add_indices(Document& document, const Mesh& mesh, const std::string& what) {
  // 65535 is the restart value of 16-bit indices, so the last usable index is 65534.
  const bool is_short = mesh.positions.size() <= 65535;
  const std::size_t begin = document.binary.size();
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = triangle[corner];
      if (index >= mesh.positions.size()) throw failure(what + " has an index out of range");
      if (is_short)
        append_value(document.binary, static_cast<std::uint16_t>(index));
      else
        append_value(document.binary, index);
    }
  }
  add_view(document, begin, kElementArrayBuffer);
  document.accessors += ",{\"bufferView\":" + std::to_string(2 * document.count + 1) +
                        ",\"componentType\":" + std::to_string(is_short ? kUnsignedShort : kUnsignedInt) +
                        ",\"count\":" + std::to_string(3 * mesh.triangles.size()) + ",\"type\":\"SCALAR\"}";
}

/// Neighbours in the list get colours far apart: hues step by the golden ratio.
std::string material(std::size_t index) {
  const double hue = std::fmod(static_cast<double>(index) * 0.618033988749895, 1.0) * 6;
  const auto channel = [hue](double at) {
    const double k = std::fmod(at + hue, 6.0);
    return 0.85 - 0.6 * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
  };
  return "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[" + number(static_cast<float>(channel(5))) + ',' +
         number(static_cast<float>(channel(3))) + ',' + number(static_cast<float>(channel(1))) +
         ",1],\"metallicFactor\":0,\"roughnessFactor\":0.7}}";
}

/// What a node's `extras` say, as load_gltf() reads it; empty where that is nothing.
std::string extras_of(const Haptics& haptics) {
  std::string values;
  const auto add = [&](const char* key, const auto& value) {
    if (value) add_item(values, '"' + std::string(key) + "\":" + number(*value));
  };
  if (!haptics.touchable) add_item(values, "\"touchable\":false");
  add("delta_m", haptics.delta_m);
  add("foci", haptics.foci);
  add("stride", haptics.stride);
  add("dwell_s", haptics.dwell_s);
  add("intensity", haptics.intensity);
  add("press_depth_m", haptics.press_depth_m);
  return values.empty() ? "" : ",\"extras\":{\"palpa\":{" + values + "}}";
}

std::string extras_of(const PartOf& part) {
  return ",\"extras\":{\"palpa\":{\"part_of\":" + json_string(part.solid) + ",\"seam_m\":" + number(part.seam_m) + "}}";
}

/// Returns the index of its node.
std::size_t add_mesh(Document& document, const SceneMesh& item, const std::string& file) {
  const std::string what = file + ": mesh " + json_string(item.name);
  if (item.mesh.triangles.empty()) throw failure(what + " has no triangles to write");
  add_positions(document, item.mesh, what);
  add_indices(document, item.mesh, what);
  const std::string name = "\"name\":" + json_string(item.name);
  std::string paint;
  if (item.part) {
    paint = ",\"material\":" + std::to_string(document.material_count);
    add_item(document.materials, material(document.material_count++));
  }
  add_item(document.meshes, '{' + name +
                                ",\"primitives\":[{\"attributes\":{\"POSITION\":" + std::to_string(2 * document.count) +
                                "},\"indices\":" + std::to_string(2 * document.count + 1) + paint + "}]}");
  const std::string extras = item.part ? extras_of(*item.part) : extras_of(item.haptics);
  return add_node(document, name + ",\"mesh\":" + std::to_string(document.count++) + extras);
}

/// The parts of one solid, under a node of the solid's name that says how the solid is to be felt.
void add_parts(Document& document, std::span<const SceneMesh> parts, const std::string& file) {
  std::string children;
  for (const SceneMesh& part : parts)
    add_item(children, std::to_string(add_mesh(document, part, file)));
  const SceneMesh& first = parts.front();
  const std::size_t parent = add_node(document, "\"name\":" + json_string(first.part->solid) + ",\"children\":[" +
                                                    children + ']' + extras_of(first.haptics));
  add_item(document.roots, std::to_string(parent));
}

std::string json(const Document& document) {
  std::string text = R"({"asset":{"version":"2.0","generator":"palpa"},"scene":0,"scenes":[{)";
  if (document.count == 0) return text + "}]}";
  text += "\"nodes\":[" + document.roots + "]}],\"nodes\":[" + document.nodes + "],\"meshes\":[" + document.meshes;
  if (!document.materials.empty()) text += "],\"materials\":[" + document.materials;
  return text + "],\"accessors\":[" + document.accessors + "],\"bufferViews\":[" + document.views +
         "],\"buffers\":[{\"byteLength\":" + std::to_string(document.binary.size()) + "}]}";
}

/// What is no file of its own, such as a pipe or a device, is written as it stands.
bool replaceable(const std::filesystem::path& file) {
  std::error_code fault;
  const auto kind = std::filesystem::symlink_status(file, fault).type();
  return kind == std::filesystem::file_type::regular || kind == std::filesystem::file_type::not_found;
}

/// Written beside its place first: whatever happens, there is the old file or the new one.
void write_whole(const std::filesystem::path& file, const std::string& bytes) {
  const bool aside = replaceable(file);
  std::filesystem::path place = file;
  if (aside) place += ".unfinished";
  const auto fail = [&] {
    const int fault = errno;
    if (aside) std::remove(place.c_str());
    return failure(file.string() + ": cannot be written: " + std::strerror(fault));
  };
  std::FILE* out = std::fopen(place.c_str(), "wb");
  if (out == nullptr) throw fail();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size() && std::fflush(out) == 0;
  const int fault = errno;
  const bool closed = std::fclose(out) == 0;
  if (!written) errno = fault;
  if (!written || !closed || (aside && std::rename(place.c_str(), file.c_str()) != 0)) throw fail();
}

}  // namespace

void write_glb(const std::filesystem::path& file, std::span<const SceneMesh> meshes) {
  Document document;
  for (std::size_t i = 0; i < meshes.size();) {
    if (!meshes[i].part) {
      add_item(document.roots, std::to_string(add_mesh(document, meshes[i], file.string())));
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < meshes.size() && meshes[end].part && meshes[end].part->solid == meshes[i].part->solid &&
           meshes[end].part->group == meshes[i].part->group)
      ++end;
    add_parts(document, meshes.subspan(i, end - i), file.string());
    i = end;
  }
  std::string text = json(document);
  pad(text, ' ');

  const bool has_binary = !document.binary.empty();
  const std::uint64_t size = 12 + 8 + text.size() + (has_binary ? 8 + document.binary.size() : 0);
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw failure(file.string() + ": more than 4 GiB do not fit into a .glb file");
  std::string bytes;
  bytes.reserve(size);
  append_value(bytes, kMagic);
  append_value(bytes, kVersion);
  append_value(bytes, static_cast<std::uint32_t>(size));
  append_value(bytes, static_cast<std::uint32_t>(text.size()));
  append_value(bytes, kJsonChunk);
  bytes += text;
  if (has_binary) {
    append_value(bytes, static_cast<std::uint32_t>(document.binary.size()));
    append_value(bytes, kBinChunk);
    bytes += document.binary;
  }
  write_whole(file, bytes);
}

}  // namespace palpa::geometry
