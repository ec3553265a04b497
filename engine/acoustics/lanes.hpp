// Sine and cosine of several floats at a time, and the boundary elements' kinds of processors (base/lanes.hpp).
#pragma once

#include "base/lanes.hpp"

namespace palpa::acoustics {

#if defined(__x86_64__)
template <class Work>
[[gnu::target("avx2,fma")]] void in_fma_lanes(const Work& work) {
  work(Lanes8{});
}
template <class Work>
[[gnu::target("avx512f,avx512dq,avx2,fma")]] void in_avx512_lanes(const Work& work) {
  work(Lanes16{});
}
#endif

/// in_lanes() with two other kinds of processor: AVX-512 with L = Lanes16, and AVX2 with FMA with L = Lanes8. Both may
/// fuse multiplications with additions, if the file is compiled with -ffp-contract=fast. Returns nothing.
template <class Work>
void in_wide_lanes(const Work& work) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return in_avx512_lanes(work);
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return in_fma_lanes(work);
#endif
  in_plain_lanes(work);
}

/// Sine and cosine of 2 pi `turns`, |turns| below 1e6, within 4e-7 of the exact values for the float `turns`.
template <class L>
[[gnu::always_inline]] inline void sine_cosine(const typename L::Float& turns, typename L::Float& sine,
                                               typename L::Float& cosine) {
  // Adding and subtracting 1.5 * 2^23 rounds to a whole number of turns.
  const typename L::Float whole = (turns + 12582912.0F) - 12582912.0F;
  const typename L::Float x = (turns - whole) * 3.14159265358979F;  // half the angle, within a quarter turn
  const typename L::Float z = x * x;
  const typename L::Float s =
      x *
      (1.0F + z * (-1.0F / 6 + z * (1.0F / 120 + z * (-1.0F / 5040 + z * (1.0F / 362880 - z * (1.0F / 39916800))))));
  const typename L::Float c =
      1.0F + z * (-0.5F + z * (1.0F / 24 +
                               z * (-1.0F / 720 + z * (1.0F / 40320 - z * (1.0F / 3628800 - z * (1.0F / 479001600))))));
  sine = 2.0F * s * c;
  cosine = 1.0F - 2.0F * s * s;
}

}  // namespace palpa::acoustics
