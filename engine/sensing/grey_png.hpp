// Grey PNG files: depth images of 16 bits, masks of 8.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace palpa::sensing {

/// Reads an image of exactly width x height into `out`, rows from the top. Throws bad_input: unreadable, no PNG, not
/// 16-bit grey (names what it is), another size (names both), truncated or corrupt. Bounded by the expected size,
/// whatever the file or one of its chunks claims. Interlaced files are fine; ancillary chunks (gamma and such) do not
/// change the values.
void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out);
/// The same of 8-bit grey.
void read_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::vector<std::uint8_t>& out);

/// Fast rather than small. Throws failure() when the file cannot be written whole.
void write_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                 std::span<const std::uint16_t> pixels);
void write_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::span<const std::uint8_t> pixels);

}  // namespace palpa::sensing
