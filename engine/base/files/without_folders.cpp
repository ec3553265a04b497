#include "base/files/without_folders.hpp"

#include <algorithm>
#include <cstddef>

namespace palpa {

std::string without_folders(std::string_view text) {
  constexpr std::string_view ends = " \t\n'\"(),;:=";
  std::string out;
  while (!text.empty()) {
    const std::size_t size = std::min(text.find_first_of(ends), text.size());
    const std::string_view word = text.substr(0, size);
    const std::size_t slash = word.find_last_of('/');
    // Not so "frames/s".
    const bool path = slash != std::string_view::npos && slash + 1 < word.size() && !word.starts_with("/dev/") &&
                      (std::string_view("/.~").find(word.front()) != std::string_view::npos ||
                       word.find('.', slash) != std::string_view::npos);
    out += path ? word.substr(slash + 1) : word;
    if (size < text.size()) out += text[size];
    text.remove_prefix(std::min(size + 1, text.size()));
  }
  return out;
}

}  // namespace palpa
