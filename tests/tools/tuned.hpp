// Makes the constants of splitting and joining adjustable. The compiler includes it before every source of
// split_sensitivity, which has its own copy of the twins.
#pragma once

#include <array>
#include <cstddef>

namespace palpa::tuning {

/// The names that touch/fingers/ gives to PALPA_TUNED.
enum Name : std::size_t {
  valley,
  noise,
  hole,
  inside,
  same,
  apart,
  facing,
  grow,
  votes,
  firm,
  company,
  rim,
  clear,
  nearest,
  away,
  towards,
  empty,
  names
};

/// What each constant is multiplied by.
inline std::array<float, names> factors = [] {
  std::array<float, names> ones{};
  ones.fill(1);
  return ones;
}();

template <typename Value>
float tuned(Name name, Value value) {
  return factors[name] * static_cast<float>(value);
}

}  // namespace palpa::tuning

#define PALPA_TUNED(name, value) ::palpa::tuning::tuned(::palpa::tuning::name, value)
