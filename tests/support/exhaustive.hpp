// How many samples a test uses: all in the matrix's leg corpus, which sets PALPA_EXHAUSTIVE, and elsewhere enough to
// show a fault.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "support/instrumented.hpp"

namespace palpa::test {

inline bool exhaustive() {
  return std::getenv("PALPA_EXHAUSTIVE") != nullptr;
}

/// The number of samples, for samples that all take the same path: `all` if exhaustive(), otherwise `some`, and a tenth
/// of `some` with sanitizers.
inline std::uint32_t samples(std::uint32_t some, std::uint32_t all) {
  return exhaustive() ? all : fewer(some);
}

}  // namespace palpa::test
