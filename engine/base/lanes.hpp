// Several floats at a time in compiler vectors. The arithmetic is the same for any width. The calling code compiles its
// loop for several kinds of processor and chooses one at run time (search_lanes.cpp, galerkin_kernels.cpp). Every
// width gives the same bits unless the kind of processor lets the compiler fuse multiplications with additions: "fma"
// does, "avx2" does not.
#pragma once

#include <cstdint>
#include <cstring>

// Vectors wider than the processor's registers are only passed within one inlined function, so no ABI is affected.
#pragma GCC diagnostic ignored "-Wpsabi"

// A function with this attribute is compiled for processors with AVX2, with all that is inlined into it. Call it only
// if has_avx2().
#if defined(__x86_64__)
#define PALPA_AVX2 [[gnu::target("avx2")]]
#else
#define PALPA_AVX2
#endif

namespace palpa {

inline bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

struct Lanes4 {
  static constexpr int width = 4;
  using Float [[gnu::vector_size(16)]] = float;
  using Bits [[gnu::vector_size(16)]] = std::int32_t;
};
struct Lanes8 {
  static constexpr int width = 8;
  using Float [[gnu::vector_size(32)]] = float;
  using Bits [[gnu::vector_size(32)]] = std::int32_t;
};
struct Lanes16 {
  static constexpr int width = 16;
  using Float [[gnu::vector_size(64)]] = float;
  using Bits [[gnu::vector_size(64)]] = std::int32_t;
};

template <class L>
[[gnu::always_inline]] inline typename L::Float load_lanes(const float* from) {
  typename L::Float value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

template <class L>
[[gnu::always_inline]] inline void store_lanes(const typename L::Float& value, float* to) {
  std::memcpy(to, &value, sizeof(value));
}

/// Whether a comparison holds in all lanes.
template <class L>
[[gnu::always_inline]] inline bool all_set(const typename L::Bits& bits) {
  Lanes4::Bits all;
  std::memcpy(&all, &bits, sizeof(all));
  for (int part = 1; part < L::width / 4; ++part) {
    Lanes4::Bits more;
    std::memcpy(&more, reinterpret_cast<const char*>(&bits) + part * sizeof(more), sizeof(more));
    all &= more;
  }
#if defined(__x86_64__)
  return __builtin_ia32_movmskps(reinterpret_cast<Lanes4::Float>(all)) == 0xf;
#else
  return (all[0] & all[1] & all[2] & all[3]) == -1;
#endif
}

/// 1 / sqrt(x) within 2e-7 for x from 1e-30 to 1e30: a first guess from the bits of x, then three Newton steps.
template <class L>
[[gnu::always_inline]] inline typename L::Float inverse_root(const typename L::Float& x) {
  typename L::Bits bits;
  std::memcpy(&bits, &x, sizeof(bits));
  bits = 0x5f3759df - (bits >> 1);
  typename L::Float y;
  std::memcpy(&y, &bits, sizeof(y));
  const typename L::Float half = x * 0.5F;
  y = y * (1.5F - half * y * y);
  y = y * (1.5F - half * y * y);
  y = y * (1.5F - half * y * y);
  return y;
}

}  // namespace palpa
