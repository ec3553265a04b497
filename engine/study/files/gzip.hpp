// Unpacks gzip files, and computes checksums, with zlib.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpa::study {

struct Unpacked {
  std::string text;
  bool cut = false;  ///< the file ends before its packed data does; `text` has everything before
};

/// Throws bad_input if the file is not gzip, is damaged, or has more than `most_bytes` unpacked.
Unpacked read_gzip(const std::filesystem::path& file, std::uint64_t most_packed, std::uint64_t most_bytes);

/// The bytes as a gzip file. The same bytes give the same file. Files may follow one another in a file, and are then
/// read as one. Throws failure() if memory is short.
std::string gzip_of(std::string_view bytes);

/// The CRC-32 of gzip and zip.
std::uint32_t crc32_of(std::string_view bytes);

}  // namespace palpa::study
