// glTF files made in tests, piece by piece, without the reader under test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "support/json.hpp"

namespace palpa::test {

class GltfBuilder {
 public:
  using Json = nlohmann::json;

  GltfBuilder();

  /// Each returns the new item's index. Data is appended to the one buffer, 4-byte aligned.
  int add_view(const std::vector<unsigned char>& bytes, int stride = 0);
  int add_positions(const std::vector<Vec3>& positions);
  int add_indices(const std::vector<std::uint32_t>& indices, int component = 5125);
  int add_mesh(int positions, int indices = -1, int mode = 4);
  int add_mesh(const geometry::Mesh& mesh);
  /// A root node of the default scene unless `root` is false.
  int add_node(Json node, bool root = true);

  std::string text(const std::string& uri) const;
  std::vector<unsigned char> glb() const;

  /// As a data URI inside, with a .bin beside it, or as a .glb.
  std::filesystem::path write_embedded(const std::filesystem::path& file) const;
  std::filesystem::path write_with_bin(const std::filesystem::path& file) const;
  std::filesystem::path write_glb(const std::filesystem::path& file) const;

  Json doc;
  std::vector<unsigned char> bin;
};

/// The bytes of numbers, little-endian.
template <typename T>
std::vector<unsigned char> bytes_of(const std::vector<T>& values) {
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  return {first, first + values.size() * sizeof(T)};
}

void write_bytes(const std::filesystem::path& file, const void* data, std::size_t size);
std::vector<unsigned char> read_bytes(const std::filesystem::path& file);

}  // namespace palpa::test
