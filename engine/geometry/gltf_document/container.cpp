#include "geometry/gltf_document/container.hpp"

#include <fmt/format.h>

#include <array>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::geometry::gltf {
namespace {

// A model of two million triangles as a data URI still fits. Parsing such a text takes about five times its size in
// memory.
constexpr std::uint64_t longest_json = 64 << 20;
constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;
constexpr std::uint64_t header_size = 12, chunk_header_size = 8;

std::string read_text(const InputFile& file, std::uint64_t offset, std::uint64_t size) {
  if (size > longest_json) {
    throw bad_input(file.name(),
                    fmt::format("its JSON is {} bytes long; palpa reads at most {} (put the buffers into a .glb)", size,
                                longest_json));
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  file.read_at(offset, std::span(reinterpret_cast<unsigned char*>(text.data()), text.size()));
  return text;
}

std::uint32_t word_at(const InputFile& file, std::uint64_t offset) {
  std::array<unsigned char, 4> b{};
  file.read_at(offset, b);
  return b[0] | static_cast<std::uint32_t>(b[1]) << 8 | static_cast<std::uint32_t>(b[2]) << 16 |
         static_cast<std::uint32_t>(b[3]) << 24;
}

Container read_glb(const InputFile& file) {
  const auto fail = [&](const std::string& fault) { throw bad_input(file.name(), fault); };
  if (file.size() < header_size) fail("is a .glb cut off within its header of 12 bytes");
  const std::uint32_t version = word_at(file, 4);
  const std::uint64_t length = word_at(file, 8);
  if (version != 2) fail(fmt::format("is a .glb of version {}; palpa reads glTF 2.0", version));
  if (length > file.size())
    fail(fmt::format("is cut off: its header promises {} bytes, the file has {}", length, file.size()));
  if (length < header_size + chunk_header_size)
    fail(fmt::format("its header promises {} bytes, too few for a JSON chunk", length));
  if (length < file.size())
    log::warning(fmt::format("{}: {} bytes after the .glb's end are ignored", file.name(), file.size() - length));
  Container container;
  std::uint64_t offset = header_size;
  // Only the first two chunks have a meaning. Later ones are extensions that are ignored, so they need not all be
  // visited.
  for (int chunk = 0; chunk < 3 && offset < length; ++chunk) {
    if (length - offset < chunk_header_size) fail(fmt::format("chunk {} is cut off", chunk));
    const std::uint64_t size = word_at(file, offset);
    const std::uint32_t type = word_at(file, offset + 4);
    offset += chunk_header_size;
    if (size > length - offset)
      fail(fmt::format("chunk {} is cut off: it promises {} bytes, {} are left", chunk, size, length - offset));
    if ((chunk == 0) != (type == json_chunk)) fail(chunk == 0 ? "its first chunk is not JSON" : "has two JSON chunks");
    if (chunk == 0) {
      if (size == 0) fail("its JSON chunk is empty");
      container.json = read_text(file, offset, size);
    } else if (type == bin_chunk) {
      if (chunk != 1) fail("its BIN chunk is not the second chunk");
      container.bin = BinChunk{offset, size};
    }
    offset += size;
  }
  return container;
}

}  // namespace

Container read_container(const InputFile& file) {
  const std::string head = file.head(1024);
  Container container;
  if (head.starts_with("glTF")) {
    container = read_glb(file);
  } else {
    const std::string_view text = text_in(head, file.name());
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos || text[first] != '{') {
      throw bad_input(file.name(), "is neither glTF (JSON, beginning with '{') nor .glb (beginning with \"glTF\")");
    }
    container.json = read_text(file, 0, file.size());
  }
  container.json = text_in(container.json, file.name());
  return container;
}

}  // namespace palpa::geometry::gltf
