#include <fmt/format.h>

#include <bit>
#include <string_view>

#include "base/files/output_file.hpp"
#include "geometry/files/ply.hpp"

namespace palpa::geometry {
namespace {

template <typename T>
void write_number(OutputFile& out, const T& number) {
  static_assert(std::endian::native == std::endian::little);
  out.write({reinterpret_cast<const char*>(&number), sizeof(T)});
}

}  // namespace

void write_ply(const std::filesystem::path& path, std::span<const Vec3> positions,
               std::span<const glm::uvec3> triangles, PlyFormat format) {
  const bool ascii = format == PlyFormat::ascii;
  OutputFile out(path);
  out.write(fmt::format("ply\nformat {} 1.0\ncomment palpa, metres\nelement vertex {}\n",
                        ascii ? "ascii" : "binary_little_endian", positions.size()));
  // Decimals that must give the same double again need the type double.
  for (const char axis : {'x', 'y', 'z'})
    out.write(fmt::format("property {} {}\n", ascii ? "double" : "float", axis));
  if (!triangles.empty()) {
    out.write(fmt::format("element face {}\nproperty list uchar int vertex_indices\n", triangles.size()));
  }
  out.write("end_header\n");
  for (const Vec3& p : positions) {
    if (ascii) {
      out.write(fmt::format("{} {} {}\n", p.x, p.y, p.z));
    } else {
      for (int i = 0; i < 3; ++i)
        write_number(out, static_cast<float>(p[i]));
    }
  }
  for (const glm::uvec3& t : triangles) {
    if (ascii) {
      out.write(fmt::format("3 {} {} {}\n", t[0], t[1], t[2]));
    } else {
      write_number(out, std::uint8_t{3});
      for (int i = 0; i < 3; ++i)
        write_number(out, t[i]);
    }
  }
  out.finish();
}

}  // namespace palpa::geometry
