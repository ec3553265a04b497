#include "geometry/files/stl.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>

#include "base/output_file.hpp"

namespace palpa::geometry {
namespace {

constexpr double mm = 1e3;
constexpr std::size_t heading_bytes = 80;

template <typename T>
void put(std::string& bytes, T number) {
  static_assert(std::endian::native == std::endian::little);
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &number, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

void put(std::string& bytes, const Vec3& v) {
  for (int i = 0; i < 3; ++i)
    put(bytes, static_cast<float>(v[i]));
}

}  // namespace

void write_stl(const std::filesystem::path& file, const Mesh& mesh) {
  std::string bytes = "palpa, millimetres";  // must not begin with "solid", which marks a text file
  bytes.resize(heading_bytes, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const Vec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    put(bytes, length > 0 ? across / length : Vec3(0));
    for (const Vec3& corner : {a, b, c})
      put(bytes, corner * mm);
    put(bytes, std::uint16_t{0});
  }
  write_file(file, bytes);
}

}  // namespace palpa::geometry
