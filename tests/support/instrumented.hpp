// Builds with sanitizers: programs are many times slower there, and fatter.
#pragma once

#include <cstdint>

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

}  // namespace palpa::test
