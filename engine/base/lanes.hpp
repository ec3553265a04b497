// Several floats at a time in compiler vectors, and loops that are compiled for several kinds of processor, one of
// which is chosen at run time. The arithmetic is the same for any width. Every width gives the same bits unless the
// kind of processor lets the compiler fuse multiplications with additions: "fma" does, "avx2" does not.
#pragma once

#include <cstdint>
#include <cstring>

// Vectors wider than the processor's registers are only passed within one inlined function, so no ABI is affected.
#pragma GCC diagnostic ignored "-Wpsabi"

// Stands after the parameters of a lambda that in_lanes() takes. What is not inlined is compiled for every processor.
#define PALPA_INLINED __attribute__((always_inline))

namespace palpa {

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

/// Four doubles at a time.
using Four [[gnu::vector_size(32)]] = double;

[[gnu::always_inline]] inline Four four(const double* from) {
  Four value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}
[[gnu::always_inline]] inline double total(const Four& sum) {
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

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

// A function of its own for each kind of processor, so that none needs the stack frame of another.
template <class Work>
[[gnu::noinline]] auto in_plain_lanes(const Work& work) {
  return work(Lanes4{});
}
#if defined(__x86_64__)
template <class Work>
[[gnu::target("avx2")]] auto in_avx2_lanes(const Work& work) {
  return work(Lanes8{});
}
#endif

/// Calls `work`, a lambda `[&]<class L>(L) PALPA_INLINED { ... }`, and returns its result. It is compiled twice, with
/// all that is inlined into it: with AVX2 and L = Lanes8, and for every processor with L = Lanes4. A lambda whose
/// vectors do not depend on the processor is `[&](auto) PALPA_INLINED { ... }`. Do not return a vector: GCC 14 warns
/// about its ABI.
template <class Work>
auto in_lanes(const Work& work) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return in_avx2_lanes(work);
#endif
  return in_plain_lanes(work);
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
