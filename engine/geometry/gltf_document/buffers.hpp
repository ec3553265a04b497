// The bytes of a glTF buffer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/files/input_file.hpp"
#include "geometry/gltf_document/document.hpp"

namespace palpa::geometry::gltf {

/// The fault of a URI itself, before anything is opened: it is neither a base64 data URI nor a relative path.
std::optional<std::string> uri_fault(const std::string& uri);

/// Exactly source.length bytes of a buffer that is not packed. Throws bad_input naming the file and the buffer: a
/// missing or irregular file, one outside the folder of `file` (see ReferenceFolder), too few bytes, broken base64.
std::vector<unsigned char> load_buffer(const InputFile& file, const std::optional<BinChunk>& bin, std::size_t index,
                                       const BufferSource& source);

/// "%20" becomes a space. nullopt for a '%' without two hexadecimal digits, and for %00.
std::optional<std::string> decode_percent(std::string_view text);

}  // namespace palpa::geometry::gltf
