// Hashes with a random seed, so that nobody can craft a file whose values all collide.
#pragma once

#include <cstdint>
#include <random>

namespace palpa::geometry {

/// The seed differs in every run. Results must not depend on it.
inline std::uint64_t hash_seed() {
  static const std::uint64_t seed = [] {
    std::random_device device;
    return std::uint64_t{device()} << 32U | device();
  }();
  return seed;
}

/// Combines `h` with one more value. The finalizer of SplitMix64: every bit of the value changes half of the result's
/// bits.
inline std::uint64_t mix_hash(std::uint64_t h, std::uint64_t value) {
  h = (h ^ value) + 0x9e3779b97f4a7c15ULL;
  h = (h ^ h >> 30U) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ h >> 27U) * 0x94d049bb133111ebULL;
  return h ^ h >> 31U;
}

}  // namespace palpa::geometry
