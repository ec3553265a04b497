// Equality to the last bit: distinguishes -0 from 0.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace palpa::test {

/// For values made only of doubles.
template <typename T>
bool same_bits(const T& a, const T& b) {
  using Words = std::array<std::uint64_t, sizeof(T) / sizeof(std::uint64_t)>;
  return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}

}  // namespace palpa::test
