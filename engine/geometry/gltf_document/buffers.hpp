// The bytes of glTF buffers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_file.hpp"
#include "geometry/gltf_document/document.hpp"

namespace palpa::geometry::gltf {

/// The fault of a URI itself, before anything is opened: it is neither a base64 data URI nor a relative path.
std::optional<std::string> uri_fault(const std::string& uri);

/// The bytes of all buffers of a document that the scene needs; the others are empty. Throws bad_input naming the file
/// and the buffer: a missing or irregular file, one outside the folder of `file` (see ReferenceFolder), too few bytes,
/// broken base64, packed bytes that cannot be unpacked.
std::vector<std::vector<unsigned char>> load_buffers(const InputFile& file, const std::optional<BinChunk>& bin,
                                                     const std::vector<BufferSource>& sources);

/// "%20" becomes a space. nullopt for a '%' without two hexadecimal digits, and for %00.
std::optional<std::string> decode_percent(std::string_view text);

}  // namespace palpa::geometry::gltf
