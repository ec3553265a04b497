// glTF files made in tests, piece by piece, without the reader under test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/mesh/mesh.hpp"
#include "support/json.hpp"
#include "support/thrown.hpp"

namespace palpa::test {

class GltfBuilder {
 public:
  using Json = nlohmann::json;

  GltfBuilder();
  /// With a mesh, and a node that shows it.
  explicit GltfBuilder(const geometry::Mesh& mesh);

  /// Each returns the new item's index. Data is appended to the one buffer, 4-byte aligned.
  int add_view(const std::vector<unsigned char>& bytes, int stride = 0);
  /// With a view of those bytes.
  int add_accessor(const std::vector<unsigned char>& bytes, int component, std::size_t count, const char* type,
                   int stride = 0);
  int add_positions(const std::vector<Vec3>& positions);
  int add_indices(const std::vector<std::uint32_t>& indices, int component = 5125);
  int add_mesh(int positions, int indices = -1, int mode = 4);
  int add_mesh(const geometry::Mesh& mesh);
  /// A root node of the default scene unless `root` is false.
  int add_node(Json node, bool root = true);

  /// The file with another value at a JSON pointer, given as JSON; without the value if `json` is empty.
  GltfBuilder with(const std::string& pointer, const std::string& json) const;

  std::string text(const std::string& uri) const;
  std::vector<unsigned char> glb() const;

  /// As a data URI inside, with a .bin beside it, or as a .glb.
  std::filesystem::path write_embedded(const std::filesystem::path& file) const;
  std::filesystem::path write_with_bin(const std::filesystem::path& file) const;
  std::filesystem::path write_glb(const std::filesystem::path& file) const;
  /// As a .glb in memory, until the next call.
  std::filesystem::path in_memory() const;

  Json doc;
  std::vector<unsigned char> bin;
};

/// The bytes of numbers, little-endian.
template <typename T>
std::vector<unsigned char> bytes_of(const std::vector<T>& values) {
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  return {first, first + values.size() * sizeof(T)};
}

/// The indices of a mesh's triangles.
std::vector<std::uint32_t> corners_of(const geometry::Mesh& mesh);

geometry::Scene load(const GltfBuilder& builder, std::optional<int> scene = std::nullopt);

/// What is written to stderr when the file is read; it must have this many meshes.
std::string warnings_of(const GltfBuilder& builder, std::size_t meshes = 1);

/// The error when `read` reads the file: it must begin with the file's name, and cost a second of processor time at
/// most. "" if there is none.
std::string fault_of_reading(const std::filesystem::path& file, const std::function<void()>& read);
/// The same when the file is read and made into solids.
std::string fault_of_file(const std::filesystem::path& file);
std::string fault_of(const GltfBuilder& builder);

/// A value that spoils a file, as GltfBuilder::with() takes it, and a part of the message about it.
struct Fault {
  std::string pointer, json, message;
};

/// Checks the message for each of them. Their pointers begin after `prefix`.
void expect_faults(const GltfBuilder& good, const std::vector<Fault>& faults, const std::string& prefix = "");

/// What stands at a place of a binary file, and a part of the message about it.
struct BadByte {
  std::size_t place;
  unsigned char value;
  const char* message;
};

void write_bytes(const std::filesystem::path& file, const void* data, std::size_t size);
std::vector<unsigned char> read_bytes(const std::filesystem::path& file);

}  // namespace palpa::test
