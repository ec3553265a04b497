#include "geometry/gltf_builder.hpp"

#include <cstring>
#include <fstream>
#include <iterator>

#include "geometry/memory_file.hpp"
#include "geometry/solid.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {

using geometry::Mesh;

GltfBuilder::GltfBuilder() {
  doc = {{"asset", {{"version", "2.0"}}},
         {"scene", 0},
         {"scenes", {{{"nodes", Json::array()}}}},
         {"nodes", Json::array()},
         {"meshes", Json::array()},
         {"accessors", Json::array()},
         {"bufferViews", Json::array()}};
}

GltfBuilder::GltfBuilder(const Mesh& mesh) : GltfBuilder() {
  add_mesh(mesh);
  add_node({{"mesh", 0}});
}

int GltfBuilder::add_view(const std::vector<unsigned char>& bytes, int stride) {
  bin.resize((bin.size() + 3) / 4 * 4);
  Json view{{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  bin.insert(bin.end(), bytes.begin(), bytes.end());
  doc["bufferViews"].push_back(view);
  return static_cast<int>(doc["bufferViews"].size()) - 1;
}

int GltfBuilder::add_accessor(const std::vector<unsigned char>& bytes, int component, std::size_t count,
                              const char* type, int stride) {
  const int view = add_view(bytes, stride);
  doc["accessors"].push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  return static_cast<int>(doc["accessors"].size()) - 1;
}

int GltfBuilder::add_positions(const std::vector<Vec3>& positions) {
  std::vector<float> values;
  for (const Vec3& p : positions) {
    for (int i = 0; i < 3; ++i)
      values.push_back(static_cast<float>(p[i]));
  }
  return add_accessor(bytes_of(values), 5126, positions.size(), "VEC3");
}

int GltfBuilder::add_indices(const std::vector<std::uint32_t>& indices, int component) {
  const auto bytes = component == 5121   ? bytes_of(std::vector<std::uint8_t>(indices.begin(), indices.end()))
                     : component == 5123 ? bytes_of(std::vector<std::uint16_t>(indices.begin(), indices.end()))
                                         : bytes_of(indices);
  return add_accessor(bytes, component, indices.size(), "SCALAR");
}

int GltfBuilder::add_mesh(int positions, int indices, int mode) {
  Json primitive{{"attributes", {{"POSITION", positions}}}};
  if (indices >= 0) primitive["indices"] = indices;
  if (mode != 4) primitive["mode"] = mode;
  doc["meshes"].push_back({{"primitives", {primitive}}});
  return static_cast<int>(doc["meshes"].size()) - 1;
}

int GltfBuilder::add_mesh(const Mesh& mesh) {
  const int positions = add_positions(mesh.positions);
  return add_mesh(positions, add_indices(corners_of(mesh)));
}

int GltfBuilder::add_node(Json node, bool root) {
  doc["nodes"].push_back(std::move(node));
  const int index = static_cast<int>(doc["nodes"].size()) - 1;
  if (root) doc["scenes"][0]["nodes"].push_back(index);
  return index;
}

GltfBuilder GltfBuilder::with(const std::string& pointer, const std::string& json) const {
  GltfBuilder changed = *this;
  const Json::json_pointer place(pointer);
  if (json.empty())
    changed.doc[place.parent_pointer()].erase(place.back());
  else
    changed.doc[place] = Json::parse(json);
  return changed;
}

std::string GltfBuilder::text(const std::string& uri) const {
  Json whole = doc;
  if (!whole.contains("buffers")) {
    whole["buffers"] = {{{"byteLength", bin.size()}}};
    if (!uri.empty()) whole["buffers"][0]["uri"] = uri;
  }
  return whole.dump();
}

std::vector<unsigned char> GltfBuilder::glb() const {
  std::string json = text("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<unsigned char> padded = bin;
  padded.resize((padded.size() + 3) / 4 * 4);
  std::vector<unsigned char> out;
  const auto word = [&](std::size_t value) {
    for (int i = 0; i < 4; ++i)
      out.push_back(static_cast<unsigned char>(value >> (8 * i)));
  };
  word(0x46546c67);
  word(2);
  word(12 + 8 + json.size() + 8 + padded.size());
  word(json.size());
  word(0x4e4f534a);
  out.insert(out.end(), json.begin(), json.end());
  word(padded.size());
  word(0x004e4942);
  out.insert(out.end(), padded.begin(), padded.end());
  return out;
}

std::filesystem::path GltfBuilder::write_embedded(const std::filesystem::path& file) const {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string uri = "data:application/octet-stream;base64,";
  for (std::size_t i = 0; i < bin.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bin.size() ? bin[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      uri += i + k <= bin.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  write_text(file, text(uri));
  return file;
}

std::filesystem::path GltfBuilder::write_with_bin(const std::filesystem::path& file) const {
  // A space in the name: it is "%20" in a URI.
  const std::string stem = file.stem().string();
  write_bytes(file.parent_path() / (stem + " data.bin"), bin.data(), bin.size());
  write_text(file, text(stem + "%20data.bin"));
  return file;
}

std::filesystem::path GltfBuilder::write_glb(const std::filesystem::path& file) const {
  const auto bytes = glb();
  write_bytes(file, bytes.data(), bytes.size());
  return file;
}

std::filesystem::path GltfBuilder::in_memory() const {
  static MemoryFile file;
  const auto bytes = glb();
  return file.write(bytes.data(), bytes.size());
}

std::vector<std::uint32_t> corners_of(const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const glm::uvec3& t : mesh.triangles)
    corners.insert(corners.end(), {t[0], t[1], t[2]});
  return corners;
}

geometry::Scene load(const GltfBuilder& builder, std::optional<int> scene) {
  return geometry::load_gltf(builder.in_memory(), scene);
}

std::string warnings_of(const GltfBuilder& builder, std::size_t meshes) {
  return stderr_of([&] { EXPECT_EQ(load(builder).meshes.size(), meshes); });
}

std::string fault_of_reading(const std::filesystem::path& file, const std::function<void()>& read) {
  [[maybe_unused]] const double start = processor_s();
  std::string line = error_of(read);
#ifdef NDEBUG
  EXPECT_LT(processor_s() - start, slowest) << line;
#endif
  EXPECT_TRUE(line.empty() || line.starts_with(file.string() + ": ")) << line;
  return line;
}

std::string fault_of_file(const std::filesystem::path& file) {
  return fault_of_reading(file, [&] { geometry::make_solids(geometry::load_gltf(file)); });
}

std::string fault_of(const GltfBuilder& builder) {
  static const std::filesystem::path folder = scratch_folder("gltf-faults");
  return fault_of_file(builder.write_glb(folder / "model.glb"));
}

void expect_faults(const GltfBuilder& good, const std::vector<Fault>& faults, const std::string& prefix) {
  for (const Fault& fault : faults)
    EXPECT_CONTAINS(fault_of(good.with(prefix + fault.pointer, fault.json)), fault.message)
        << fault.pointer << fault.json;
}

void write_bytes(const std::filesystem::path& file, const void* data, std::size_t size) {
  std::ofstream(file, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

std::vector<unsigned char> read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace palpa::test
