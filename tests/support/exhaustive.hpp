// How much a test looks at: everything in the matrix's leg corpus, which has PALPA_EXHAUSTIVE in its environment, and
// elsewhere as much as shows whether it holds.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "support/instrumented.hpp"

namespace palpa::test {

inline bool exhaustive() {
  return std::getenv("PALPA_EXHAUSTIVE") != nullptr;
}

/// The number of samples that all go the same way: `all` if everything is looked at, otherwise this many, and a tenth
/// of that with sanitizers.
inline std::uint32_t samples(std::uint32_t some, std::uint32_t all) {
  return exhaustive() ? all : fewer(some);
}

}  // namespace palpa::test
