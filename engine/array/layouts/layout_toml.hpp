// The reader of layout TOMLs.
#pragma once

#include <string>
#include <string_view>

#include "array/layouts/layout.hpp"

namespace palpa::array {

/// Maximum file size. Larger files and anything but regular files are refused without reading. 65,000 transducers
/// written with every digit take about 10 MB.
inline constexpr std::uint64_t max_layout_bytes = std::uint64_t{16} << 20;

/// Throws bad_input naming file, line and key.
Layout load_layout_toml(const std::string& file);
/// The same for text in memory; `file` is only its name in messages.
Layout parse_layout_toml(std::string_view text, const std::string& file);

}  // namespace palpa::array
