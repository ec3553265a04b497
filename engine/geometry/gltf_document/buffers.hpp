// The bytes of a glTF buffer.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_file.hpp"
#include "geometry/gltf_document/check.hpp"

namespace palpa::geometry::gltf {

/// The fault of a URI itself, before anything is opened: it is neither a base64 data URI nor a relative path.
std::optional<std::string> uri_fault(const std::string& uri);

/// Exactly source.length bytes: from the BIN chunk, a data URI, or a file beside `file`. `source` must not be packed.
/// Throws bad_input naming `file` and buffer `index`: a missing or irregular file, one outside the folder of `file`
/// (see ReferenceFolder), too few bytes, broken base64.
std::vector<unsigned char> load_buffer(const InputFile& file, const std::optional<BinChunk>& bin, std::size_t index,
                                       const BufferSource& source);

/// All buffers of a document. Each is loaded only once, even if many views are unpacked from it.
class BufferLoader {
 public:
  BufferLoader(const InputFile& file, const std::optional<BinChunk>& bin, const std::vector<BufferSource>& sources)
      : file_(file), bin_(bin), sources_(sources) {}

  /// As load_buffer(), also for packed buffers; bad_input if they cannot be unpacked.
  std::vector<unsigned char> load(std::size_t index);

 private:
  const InputFile& file_;
  const std::optional<BinChunk>& bin_;
  const std::vector<BufferSource>& sources_;
  std::map<std::size_t, std::vector<unsigned char>> packed_;  // buffers from which others are unpacked
};

/// nullopt unless the whole text is base64 (with or without padding).
std::optional<std::vector<unsigned char>> decode_base64(std::string_view text);

/// "%20" becomes a space. nullopt for a '%' without two hexadecimal digits, and for %00.
std::optional<std::string> decode_percent(std::string_view text);

}  // namespace palpa::geometry::gltf
