#include "geometry/gltf_document/buffers.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/reference.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

// nullopt unless the whole text is base64 (with or without padding).
std::optional<std::vector<unsigned char>> decode_base64(std::string_view text) {
  static constexpr auto value = [] {
    std::array<unsigned char, 256> table{};
    table.fill(0xff);
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < digits.size(); ++i)
      table[static_cast<unsigned char>(digits[i])] = static_cast<unsigned char>(i);
    return table;
  }();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding)
    text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<unsigned char> bytes(text.size() * 6 / 8);
  auto out = bytes.begin();
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const unsigned char digit = value[static_cast<unsigned char>(c)];
    if (digit == 0xff) return std::nullopt;
    bits = bits << 6 | digit;
    held += 6;
    if (held >= 8) {
      held -= 8;
      *out++ = static_cast<unsigned char>(bits >> held);
    }
  }
  return bytes;
}

std::vector<unsigned char> decode_data_uri(const BufferSource& source, const auto& fail) {
  const std::string_view uri = source.uri;
  const std::size_t comma = uri.find(',');
  const std::string_view text = uri.substr(comma + 1);
  auto bytes = decode_base64(text);
  if (!bytes) fail("its data URI is not base64");
  if (bytes->size() < source.length) {
    fail(fmt::format("\"byteLength\" is {}, but its data URI holds {} bytes", source.length, bytes->size()));
  }
  bytes->resize(source.length);
  return *std::move(bytes);
}

}  // namespace

std::optional<std::string> uri_fault(const std::string& uri) {
  if (uri.starts_with("data:")) {
    // data:[media type][;parameter]...;base64,DATA
    const std::string_view head = std::string_view(uri).substr(0, uri.find(','));
    if (head.size() == uri.size() || !head.ends_with(";base64") || head.find(";;") != std::string_view::npos) {
      return "its data URI is not \"data:application/octet-stream;base64,...\"";
    }
    return std::nullopt;
  }
  const auto path = decode_percent(uri);
  if (!path || path->empty() || path->starts_with('/') ||
      path->substr(0, path->find('/')).find(':') != std::string::npos) {
    return fmt::format("its uri {} is not a relative path", text::quoted(uri));
  }
  return std::nullopt;
}

std::optional<std::string> decode_percent(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned value = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const auto [rest, fault] = std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16);
    if (fault != std::errc{} || rest != text.data() + i + 3 || value == 0) return std::nullopt;
    out += static_cast<char>(value);
    i += 2;
  }
  return out;
}

std::vector<unsigned char> load_buffer(const InputFile& file, const std::optional<BinChunk>& bin, std::size_t index,
                                       const BufferSource& source) {
  const auto fail = [&](const std::string& fault) {
    throw bad_input(file.name(), fmt::format("buffer {}: {}", index, fault));
  };
  std::vector<unsigned char> bytes;
  if (source.uri.starts_with("data:")) return decode_data_uri(source, fail);
  if (source.uri.empty()) {
    bytes.resize(source.length);
    file.read_at(bin.value().offset, bytes);
    return bytes;
  }
  const std::string path = decode_percent(source.uri).value();
  ReferenceFolder folder(file.name(), std::filesystem::path(file.name()).parent_path());
  const std::filesystem::path named = folder.find(path, fmt::format("buffer {}", index));
  try {
    const InputFile beside(named);
    if (beside.size() < source.length) {
      fail(fmt::format("\"byteLength\" is {}, but {} has {} bytes", source.length, text::quoted(path), beside.size()));
    }
    bytes.resize(source.length);
    beside.read_at(0, bytes);
  } catch (const Error& e) {
    if (e.code() != Exit::bad_input) throw;
    // Names the model, which is what the user gave, followed by the fault of the part.
    const std::string_view line = e.what();
    if (line.starts_with(file.name() + ": buffer")) throw;
    fail(fmt::format("its file {}", line));
  }
  return bytes;
}

}  // namespace palpa::geometry::gltf
