// Counts parts of texts.
#pragma once

#include <cstddef>
#include <string>

namespace palpa::test {

/// How often a text contains `part`.
inline std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

}  // namespace palpa::test
