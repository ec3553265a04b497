// The bytes behind a glTF buffer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_file.hpp"
#include "geometry/gltf_check.hpp"

namespace palpa::geometry::gltf {

/// What is wrong with a URI as such, before anything is opened: it is neither a data URI of base64 nor a relative path.
std::optional<std::string> uri_fault(const std::string& uri);

/// Exactly source.length bytes: of the BIN chunk, of a data URI, or of a file beside `file`. Throws bad_input naming
/// `file` and buffer `index`: a missing or irregular file, too few bytes, broken
/// base64.
std::vector<unsigned char> load_buffer(const InputFile& file, const std::optional<BinChunk>& bin, std::size_t index,
                                       const BufferSource& source);

/// nullopt unless the whole text is base64 (with or without its padding).
std::optional<std::vector<unsigned char>> decode_base64(std::string_view text);

/// "%20" becomes a space. nullopt for a '%' without two hexadecimal digits, and for %00.
std::optional<std::string> decode_percent(std::string_view text);

}  // namespace palpa::geometry::gltf
