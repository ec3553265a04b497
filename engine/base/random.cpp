#include "base/random.hpp"

#include "base/normal.hpp"

namespace palpa {

std::uint64_t Random::next() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double Random::uniform() {
  return (static_cast<double>(next() >> 11) + 0.5) * 0x1p-53;
}

std::size_t Random::below(std::size_t count) {
  // The upper 32 bits, scaled. The bias is below 1e-6 for the counts of people in a study.
  return static_cast<std::size_t>(((next() >> 32) * count) >> 32);
}

double Random::normal() {
  return normal_quantile(uniform());
}

float Random::normal_float() {
  return normal_quantile_float(uniform());
}

std::uint32_t Random::binomial(std::uint32_t trials, double p) {
  std::uint32_t successes = 0;
  for (std::uint32_t i = 0; i < trials; ++i)
    successes += uniform() < p ? 1 : 0;
  return successes;
}

}  // namespace palpa
