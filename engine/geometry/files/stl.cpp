#include "geometry/files/stl.hpp"

#include <bit>
#include <cstdint>
#include <string>

#include "base/files/output_file.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

constexpr double mm = 1e3;
constexpr std::size_t heading_bytes = 80;

template <typename T>
void put(std::string& bytes, const T& number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(T));
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
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    put(bytes, unit_normal(mesh, t));
    for (int i = 0; i < 3; ++i)
      put(bytes, mesh.positions[mesh.triangles[t][i]] * mm);
    put(bytes, std::uint16_t{0});
  }
  write_file(file, bytes);
}

}  // namespace palpa::geometry
