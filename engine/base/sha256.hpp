// SHA-256 (FIPS 180-4), by which results name the files that they were computed from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpa {

/// 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

struct FileDigest {
  std::string sha256;
  std::uint64_t bytes = 0;
};
/// Reads the whole file, piece by piece. Throws bad_input as InputFile does; an empty file is refused.
FileDigest sha256_of_file(const std::filesystem::path& file);

}  // namespace palpa
