// Builds with sanitizers: programs are many times slower there and need more memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace palpa::test {

constexpr bool instrumented() {
#if defined(PALPA_ADDRESS_SANITIZER) || defined(PALPA_THREAD_SANITIZER)
  return true;
#else
  return false;
#endif
}

/// A tenth of the samples with sanitizers, for samples that all take the same path. Builds with sanitizers check the
/// use of memory; the build without them checks that every result is right.
constexpr std::uint32_t fewer(std::uint32_t samples) {
  return instrumented() ? samples / 10 : samples;
}

/// With sanitizers, only the first cases, this many, of those that all take the same path.
template <typename Case>
std::vector<Case> the_first(std::size_t few, std::vector<Case> cases) {
  if (instrumented()) cases.erase(cases.begin() + static_cast<std::ptrdiff_t>(few), cases.end());
  return cases;
}

/// With sanitizers, every third case of those that all take the same path.
template <typename Case>
std::vector<Case> every_third(std::vector<Case> cases) {
  if (!instrumented()) return cases;
  std::vector<Case> third;
  for (std::size_t i = 0; i < cases.size(); i += 3)
    third.push_back(std::move(cases[i]));
  return third;
}

}  // namespace palpa::test
