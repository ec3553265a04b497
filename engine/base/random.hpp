// Random numbers that are the same on every machine. The standard library's distributions are not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpa {

/// SplitMix64: 64 bits of state, one step per number.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next();
  /// Uniform in (0, 1), never 0 or 1.
  double uniform();
  /// Uniform in 0 ... count - 1.
  std::size_t below(std::size_t count);
  double normal();
  float normal_float();  ///< normal(), rounded
  /// The number of successes of `trials`, each with the probability p.
  std::uint32_t binomial(std::uint32_t trials, double p);

 private:
  std::uint64_t state_;
};

}  // namespace palpa
