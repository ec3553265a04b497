// Builds with sanitizers: programs are many times slower there, and fatter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpa::test {

constexpr bool instrumented() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

/// Of samples that all go the same way, a tenth with sanitizers: those show how memory is used, the build without them
/// that every answer is right.
constexpr std::uint32_t fewer(std::uint32_t samples) {
  return instrumented() ? samples / 10 : samples;
}

/// Of cases that all go the same way, so many of the first with sanitizers.
template <typename Case>
std::vector<Case> the_first(std::size_t few, std::vector<Case> cases) {
  if (instrumented()) cases.erase(cases.begin() + static_cast<std::ptrdiff_t>(few), cases.end());
  return cases;
}

}  // namespace palpa::test
