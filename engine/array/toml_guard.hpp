// What has to be checked before a TOML from a stranger goes to the parser.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace palpa::array {

/// Values and lines that a file may have: the parser needs a microsecond and up to 300 bytes for each. 65,536
/// transducers, three lines and six numbers each, have 850,000.
inline constexpr std::uint64_t max_toml_items = 1'200'000;
/// Parts of a dotted key. The parser nests one table per part and destroys them recursively: a line of a million dots
/// would exhaust the stack.
inline constexpr std::uint32_t max_key_parts = 8;

/// Throws bad_input where `text` has more of either, naming the line. Says nothing about whether it is TOML.
void guard_toml(std::string_view text, const std::string& file);

/// A parser's message fit for an error line: control characters and line breaks replaced, at most 200 bytes.
std::string one_line(std::string_view message);

}  // namespace palpa::array
