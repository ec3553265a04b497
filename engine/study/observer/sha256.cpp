#include "study/observer/sha256.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpa::study {
namespace {

/// The first 32 bits of the fraction of the roots of the first primes: the constants of the standard.
template <std::size_t count, typename Root>
std::array<std::uint32_t, count> fractions(Root root) {
  std::array<std::uint32_t, count> words{};
  std::size_t found = 0;
  for (unsigned candidate = 2; found < count; ++candidate) {
    bool prime = true;
    for (unsigned d = 2; d * d <= candidate; ++d)
      prime = prime && candidate % d != 0;
    if (!prime) continue;
    const long double value = root(static_cast<long double>(candidate));
    words[found++] = static_cast<std::uint32_t>((value - std::floor(value)) * 4294967296.0L);
  }
  return words;
}

}  // namespace

std::string sha256(std::string_view text) {
  static const auto k = fractions<64>([](long double p) { return std::cbrt(p); });
  std::array<std::uint32_t, 8> hash = fractions<8>([](long double p) { return std::sqrt(p); });
  std::vector<std::uint8_t> bytes(text.begin(), text.end());
  bytes.push_back(0x80);
  while (bytes.size() % 64 != 56)
    bytes.push_back(0);
  const std::uint64_t bits = std::uint64_t{text.size()} * 8;
  for (int shift = 56; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  for (std::size_t block = 0; block < bytes.size(); block += 64) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < 16; ++i) {
      for (std::size_t b = 0; b < 4; ++b)
        w[i] = w[i] << 8 | bytes[block + 4 * i + b];
    }
    for (std::size_t i = 16; i < 64; ++i) {
      const std::uint32_t s0 = std::rotr(w[i - 15], 7) ^ std::rotr(w[i - 15], 18) ^ w[i - 15] >> 3;
      const std::uint32_t s1 = std::rotr(w[i - 2], 17) ^ std::rotr(w[i - 2], 19) ^ w[i - 2] >> 10;
      w[i] = w[i - 16] + s0 + w[i - 7] + s1;
    }
    std::array<std::uint32_t, 8> v = hash;
    for (std::size_t i = 0; i < 64; ++i) {
      const std::uint32_t s1 = std::rotr(v[4], 6) ^ std::rotr(v[4], 11) ^ std::rotr(v[4], 25);
      const std::uint32_t first = v[7] + s1 + ((v[4] & v[5]) ^ (~v[4] & v[6])) + k[i] + w[i];
      const std::uint32_t s0 = std::rotr(v[0], 2) ^ std::rotr(v[0], 13) ^ std::rotr(v[0], 22);
      const std::uint32_t second = s0 + ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
      v = {first + second, v[0], v[1], v[2], v[3] + first, v[4], v[5], v[6]};
    }
    for (std::size_t i = 0; i < 8; ++i)
      hash[i] += v[i];
  }
  std::string hex;
  for (const std::uint32_t word : hash)
    hex += fmt::format("{:08x}", word);
  return hex;
}

}  // namespace palpa::study
