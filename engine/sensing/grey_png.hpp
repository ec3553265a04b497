// Grey PNG files: 16-bit depth images, 8-bit masks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::sensing {

/// Reads an image of exactly width x height into `out`, rows from the top. Throws bad_input: unreadable, not a PNG, not
/// 16-bit grey (names the actual kind), another size (names both), truncated or corrupt. Memory is bounded by the
/// expected size, whatever the file or one of its chunks claims. Interlaced files are supported; ancillary chunks (such
/// as gamma) do not change the values.
void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out);
/// The same for 8-bit grey.
void read_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::vector<std::uint8_t>& out);

/// The same, with the text that write_png16 was given as `camera`, or an empty one.
void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out, std::string& camera);

/// The same from memory. Returns what is wrong with it, in words that follow a name; empty if nothing is.
std::string decode_png16(std::string_view png, std::uint32_t width, std::uint32_t height,
                         std::vector<std::uint16_t>& out);

/// Optimised for speed rather than size. Throws failure() if the file cannot be written completely.
void write_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                 std::span<const std::uint16_t> pixels, const std::string& camera = {});
void write_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::span<const std::uint8_t> pixels);

}  // namespace palpa::sensing
