#include "acoustics/boundary/far_sums.hpp"

#include <numbers>

#include "acoustics/lanes.hpp"

namespace palpa::acoustics {
namespace {

/// A multiple of the lanes of every processor. Samples of one block stay in the fastest cache for all waves.
constexpr std::size_t block = 1024, padding = 16;

template <class L>
[[gnu::always_inline]] inline float total(const typename L::Float& lanes) {
  float sum = 0;
  for (int lane = 0; lane < L::width; ++lane)
    sum += lanes[lane];
  return sum;
}

template <class L>
[[gnu::always_inline]] inline void sums_in(const FarSamples& samples, const std::array<float, 3>& direction,
                                           std::span<const float> pressures, std::span<std::complex<double>> sums) {
  using Float = typename L::Float;
  constexpr std::size_t width = L::width;
  const std::size_t count = samples.padded();
  float re[block], im[block];
  for (std::complex<double>& sum : sums)
    sum = 0;
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t here = count - first < block ? count - first : block;
    for (std::size_t i = 0; i < here; i += width) {
      // Without a lambda that returns them: GCC 14 warns about the ABI of a wide return value, even if it is inlined.
      const std::size_t at = first + i;
      const Float x = load_lanes<L>(samples.numbers(0) + at), u = load_lanes<L>(samples.numbers(3) + at),
                  y = load_lanes<L>(samples.numbers(1) + at), v = load_lanes<L>(samples.numbers(4) + at),
                  z = load_lanes<L>(samples.numbers(2) + at), w = load_lanes<L>(samples.numbers(5) + at);
      const Float turns = -(x * direction[0] + y * direction[1] + z * direction[2]);
      const Float towards = u * direction[0] + v * direction[1] + w * direction[2];
      Float sine, cosine;
      sine_cosine<L>(turns, sine, cosine);
      store_lanes<L>(towards * cosine, re + i);
      store_lanes<L>(towards * sine, im + i);
    }
    for (std::size_t wave = 0; wave < sums.size(); ++wave) {
      const float* const p_re = &pressures[2 * wave * count + first];
      const float* const p_im = p_re + count;
      Float sum_re{}, sum_im{};
      for (std::size_t i = 0; i < here; i += width) {
        const Float a = load_lanes<L>(re + i), b = load_lanes<L>(im + i);
        const Float c = load_lanes<L>(p_re + i), d = load_lanes<L>(p_im + i);
        sum_re += a * c - b * d;
        sum_im += a * d + b * c;
      }
      sums[wave] += std::complex<double>(static_cast<double>(total<L>(sum_re)), static_cast<double>(total<L>(sum_im)));
    }
  }
}

}  // namespace

FarSamples::FarSamples(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const double> areas,
                       const Vec3& centre, double wave_number) {
  const double turns = wave_number / (2 * std::numbers::pi);
  const std::size_t padded = (points.size() + padding - 1) / padding * padding;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    of_[axis].resize(padded);
    of_[3 + axis].resize(padded);
    const auto component = static_cast<int>(axis);
    for (std::size_t i = 0; i < points.size(); ++i) {
      of_[axis][i] = static_cast<float>(turns * (points[i] - centre)[component]);
      of_[3 + axis][i] = static_cast<float>(areas[i] * normals[i][component]);
    }
  }
}

void far_sums(const FarSamples& samples, const Vec3& direction, std::span<const float> pressures,
              std::span<std::complex<double>> sums) {
  const std::array<float, 3> towards = {static_cast<float>(direction.x), static_cast<float>(direction.y),
                                        static_cast<float>(direction.z)};
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { sums_in<L>(samples, towards, pressures, sums); });
}

}  // namespace palpa::acoustics
