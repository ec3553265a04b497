#include <fmt/format.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>

#include "base/error.hpp"
#include "geometry/ply.hpp"

namespace palpa::geometry {
namespace {

// Collects bytes and writes them in large pieces; the first fault throws.
class Output {
 public:
  explicit Output(const std::filesystem::path& path) : name_(path.string()), file_(std::fopen(path.c_str(), "wbe")) {
    if (!file_) fail();
    // fmt and the buffer below already collect: a second copy would only cost time.
    std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  }
  void add(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() > 1 << 16) flush();
  }
  template <typename T>
  void add_number(T number) {
    static_assert(std::endian::native == std::endian::little);
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &number, sizeof(T));
    add({bytes.data(), bytes.size()});
  }
  void close() {
    flush();
    if (std::fclose(file_.release()) != 0) fail();
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void flush() {
    if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) != buffer_.size()) fail();
    buffer_.clear();
  }
  [[noreturn]] void fail() const {
    throw failure(name_ + ": cannot be written: " + std::generic_category().message(errno));
  }

  std::string name_, buffer_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace

void write_ply(const std::filesystem::path& path, std::span<const Vec3> positions,
               std::span<const glm::uvec3> triangles, PlyFormat format) {
  const bool ascii = format == PlyFormat::ascii;
  Output out(path);
  out.add(fmt::format("ply\nformat {} 1.0\ncomment palpa, metres\nelement vertex {}\n",
                      ascii ? "ascii" : "binary_little_endian", positions.size()));
  // A decimal that is to give the same double again belongs to a double.
  for (const char axis : {'x', 'y', 'z'})
    out.add(fmt::format("property {} {}\n", ascii ? "double" : "float", axis));
  if (!triangles.empty()) {
    out.add(fmt::format("element face {}\nproperty list uchar int vertex_indices\n", triangles.size()));
  }
  out.add("end_header\n");
  for (const Vec3& p : positions) {
    if (ascii) {
      out.add(fmt::format("{} {} {}\n", p.x, p.y, p.z));
    } else {
      for (int i = 0; i < 3; ++i)
        out.add_number(static_cast<float>(p[i]));
    }
  }
  for (const glm::uvec3& t : triangles) {
    if (ascii) {
      out.add(fmt::format("3 {} {} {}\n", t[0], t[1], t[2]));
    } else {
      out.add_number(std::uint8_t{3});
      for (int i = 0; i < 3; ++i)
        out.add_number(t[i]);
    }
  }
  out.close();
}

}  // namespace palpa::geometry
