// The container of a glTF file: the JSON text, and the BIN chunk of a .glb.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/files/input_file.hpp"

namespace palpa::geometry::gltf {

struct BinChunk {
  std::uint64_t offset, size;  ///< bytes in the file
};

struct Container {
  std::string json;             ///< without a byte order mark
  std::optional<BinChunk> bin;  ///< only in a .glb
};

/// The first bytes determine the kind, not the name. Throws bad_input: neither kind; glTF 1.0; lengths that do not fit
/// the file; JSON of more than 64 MiB.
Container read_container(const InputFile& file);

}  // namespace palpa::geometry::gltf
