#include "acoustics/field/incident_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "acoustics/lanes.hpp"
#include "array/field/turns.hpp"
#include "shaders/shared/sine_of_turns.h"

namespace palpa::acoustics {

using array::Layout;
using array::Transducer;

PointBlock::PointBlock(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t first)
    : count(std::min(block_points, points.size() - first)) {
  for (std::size_t i = 0; i < block_points; ++i) {
    const std::size_t at = first + std::min(i, count - 1);
    x[i] = points[at].x;
    y[i] = points[at].y;
    z[i] = points[at].z;
    const Vec3 normal = normals.empty() ? Vec3(0) : normals[at];
    nx[i] = static_cast<float>(normal.x);
    ny[i] = static_cast<float>(normal.y);
    nz[i] = static_cast<float>(normal.z);
  }
}

TransferSetting::TransferSetting(const Layout& layout, const Air& air, array::Directivity directivity)
    : turns_per_metre(air.medium.turns_per_metre()),
      wave_number(static_cast<float>(air.wave_number())),
      absorption(static_cast<float>(air.absorption_np_m)),
      // At the transducer itself there is no direction; no divisor is smaller than this.
      closest(std::max(static_cast<float>(layout.transducer_radius_m), 1e-9F)) {
  const std::vector<double> values =
      array::directivity_table(directivity, air.wave_number() * layout.transducer_radius_m);
  for (std::size_t i = 0; i + 1 < values.size(); ++i)
    table.push_back({static_cast<float>(values[i]), static_cast<float>(values[i + 1] - values[i])});
}

namespace {

/// Rounds to the nearest whole number, up to 2^22.
[[gnu::always_inline]] inline float nearest(float x) {
  constexpr float shift = 12582912.0F;  // 1.5 * 2^23
  return (x + shift) - shift;
}

/// e^{-x} for x in 0..80, within 2e-7; e^{-80} beyond.
[[gnu::always_inline]] inline float fading(float x) {
  const float halvings = std::min(x, 80.0F) * 1.44269504F;
  const float whole = nearest(halvings);
  const float rest = (whole - halvings) * 0.69314718F;  // -0.35..0.35
  float series = 1.0F / 720;
  series = series * rest + 1.0F / 120;
  series = series * rest + 1.0F / 24;
  series = series * rest + 1.0F / 6;
  series = series * rest + 0.5F;
  series = series * rest + 1.0F;
  series = series * rest + 1.0F;
  return series * std::bit_cast<float>((127 - static_cast<std::int32_t>(whole)) << 23);
}

[[gnu::always_inline]] inline void transfer_all(const TransferSetting& setting, const Transducer& from,
                                                const PointBlock& to, bool slopes, TransferBlock& out) {
  constexpr auto steps = static_cast<float>(array::directivity_steps);
  const auto ax = static_cast<float>(from.axis.x), ay = static_cast<float>(from.axis.y),
             az = static_cast<float>(from.axis.z);
  const TransferSetting::Entry* const table = setting.table.data();
  const float closest = setting.closest, alpha = setting.absorption, k = setting.wave_number;

  // From the transducer to the point: unit vector, distance, and the fraction of the distance beyond whole wavelengths.
  BlockOf<float> x, y, z, distance, turns;
  for (std::size_t i = 0; i < block_points; ++i) {
    const double dx = to.x[i] - from.position.x, dy = to.y[i] - from.position.y, dz = to.z[i] - from.position.z;
    const double d = std::sqrt(dx * dx + dy * dy + dz * dz);
    const double all = d * setting.turns_per_metre;
    turns[i] = static_cast<float>(all - array::nearest(all));
    distance[i] = static_cast<float>(d);
    x[i] = static_cast<float>(dx);
    y[i] = static_cast<float>(dy);
    z[i] = static_cast<float>(dz);
  }
  BlockOf<float> slant, inverse, loud, rise;
  for (std::size_t i = 0; i < block_points; ++i) {
    inverse[i] = 1 / std::max(distance[i], 1e-9F);
    slant[i] = (x[i] * ax + y[i] * ay + z[i] * az) * inverse[i];
    // At the transducer itself, as on its axis.
    slant[i] = distance[i] > 0 ? slant[i] : 1.0F;
  }
  for (std::size_t i = 0; i < block_points; ++i) {
    const float place = std::clamp((slant[i] + 1) * (0.5F * steps), 0.0F, steps);
    const auto step = std::min(static_cast<std::int32_t>(place), static_cast<std::int32_t>(steps) - 1);
    const TransferSetting::Entry& entry = table[static_cast<std::size_t>(step)];
    loud[i] = entry.value + entry.rise * (place - static_cast<float>(step));
    rise[i] = entry.rise * (0.5F * steps);
  }
  for (std::size_t i = 0; i < block_points; ++i) {
    const float near = 1 / std::max(distance[i], closest) * fading(alpha * distance[i]);
    loud[i] *= near;
    rise[i] *= near;
  }
  BlockOf<float> cosine, sine;
  for (std::size_t i = 0; i < block_points; ++i) {
    const float size = std::abs(turns[i]);
    // Uses the quarter turn on either side of the steep part of each curve.
    cosine[i] = shader::sine_of_turns(0.25F - size);
    sine[i] = std::copysign(shader::sine_of_turns(0.25F - std::abs(0.25F - size)), turns[i]);
    out.re[i] = loud[i] * cosine[i];
    out.im[i] = loud[i] * sine[i];
  }
  if (!slopes) return;
  for (std::size_t i = 0; i < block_points; ++i) {
    const float along = (x[i] * to.nx[i] + y[i] * to.ny[i] + z[i] * to.nz[i]) * inverse[i];
    const float axis = ax * to.nx[i] + ay * to.ny[i] + az * to.nz[i];
    const float spread = distance[i] > closest ? alpha + inverse[i] : alpha;
    const float grows = rise[i] * (axis - slant[i] * along) * inverse[i] - spread * along * loud[i];
    const float turn = k * along * loud[i];
    out.slope_re[i] = grows * cosine[i] - turn * sine[i];
    out.slope_im[i] = grows * sine[i] + turn * cosine[i];
  }
}

/// Sums stay in registers from transducer to transducer, for `lanes` points at a time.
template <class L>
[[gnu::always_inline]] inline void add_lanes(std::span<const std::complex<float>> strengths,
                                             std::span<const TransferBlock> sounds, BlockOf<float> TransferBlock::*g_re,
                                             BlockOf<float> TransferBlock::*g_im, BlockOf<float>& sum_re,
                                             BlockOf<float>& sum_im) {
  constexpr std::size_t width = L::width;
  static_assert(block_points % (2 * width) == 0);
  for (std::size_t i = 0; i < block_points; i += 2 * width) {
    typename L::Float re0 = load_lanes<L>(&sum_re[i]), re1 = load_lanes<L>(&sum_re[i + width]);
    typename L::Float im0 = load_lanes<L>(&sum_im[i]), im1 = load_lanes<L>(&sum_im[i + width]);
    for (std::size_t t = 0; t < sounds.size(); ++t) {
      const float a = strengths[t].real(), b = strengths[t].imag();
      const float* const from_re = (sounds[t].*g_re).data() + i;
      const float* const from_im = (sounds[t].*g_im).data() + i;
      const typename L::Float g0 = load_lanes<L>(from_re), g1 = load_lanes<L>(from_re + width);
      const typename L::Float h0 = load_lanes<L>(from_im), h1 = load_lanes<L>(from_im + width);
      re0 += a * g0 - b * h0;
      re1 += a * g1 - b * h1;
      im0 += a * h0 + b * g0;
      im1 += a * h1 + b * g1;
    }
    store_lanes<L>(re0, &sum_re[i]);
    store_lanes<L>(re1, &sum_re[i + width]);
    store_lanes<L>(im0, &sum_im[i]);
    store_lanes<L>(im1, &sum_im[i + width]);
  }
}

template <class L>
[[gnu::always_inline]] inline void add_all(std::span<const std::complex<float>> strengths,
                                           std::span<const TransferBlock> sounds, bool slopes, SumBlock& sum) {
  add_lanes<L>(strengths, sounds, &TransferBlock::re, &TransferBlock::im, sum.re, sum.im);
  if (slopes)
    add_lanes<L>(strengths, sounds, &TransferBlock::slope_re, &TransferBlock::slope_im, sum.slope_re, sum.slope_im);
}

/// A row's sums stay in registers from point to point.
template <class L>
[[gnu::always_inline]] inline void receive_all(std::span<const SourceBlock> rows, const TransferBlock& sound,
                                               std::span<LaneSums> sums) {
  constexpr std::size_t width = L::width, parts = sum_lanes / width;
  static_assert(block_points % sum_lanes == 0 && sum_lanes % width == 0);
  using Float = typename L::Float;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    Float re[parts], im[parts];
    for (std::size_t part = 0; part < parts; ++part) {
      re[part] = load_lanes<L>(&sums[row].re[part * width]);
      im[part] = load_lanes<L>(&sums[row].im[part * width]);
    }
    for (std::size_t i = 0; i < block_points; i += sum_lanes) {
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = i + part * width;
        const Float a = load_lanes<L>(&rows[row].re[at]), b = load_lanes<L>(&rows[row].im[at]);
        const Float g = load_lanes<L>(&sound.re[at]), h = load_lanes<L>(&sound.im[at]);
        re[part] += a * g - b * h;
        im[part] += a * h + b * g;
      }
    }
    for (std::size_t part = 0; part < parts; ++part) {
      store_lanes<L>(re[part], &sums[row].re[part * width]);
      store_lanes<L>(im[part], &sums[row].im[part * width]);
    }
  }
}

}  // namespace

void transfer(const TransferSetting& setting, const Transducer& from, const PointBlock& to, bool slopes,
              TransferBlock& out) {
  in_lanes([&](auto) PALPA_INLINED { transfer_all(setting, from, to, slopes, out); });
}

void add_products(std::span<const std::complex<float>> strengths, std::span<const TransferBlock> sounds, bool slopes,
                  SumBlock& sum) {
  in_lanes([&]<class L>(L) PALPA_INLINED { add_all<L>(strengths, sounds, slopes, sum); });
}

void add_slopes(std::complex<float> factor, TransferBlock& sound) {
  const float a = factor.real(), b = factor.imag();
  for (std::size_t i = 0; i < block_points; ++i) {
    sound.re[i] += a * sound.slope_re[i] - b * sound.slope_im[i];
    sound.im[i] += a * sound.slope_im[i] + b * sound.slope_re[i];
  }
}

void add_received(std::span<const SourceBlock> rows, const TransferBlock& sound, std::span<LaneSums> sums) {
  in_lanes([&]<class L>(L) PALPA_INLINED { receive_all<L>(rows, sound, sums); });
}

std::complex<double> LaneSums::total() const {
  double real = 0, imaginary = 0;
  for (std::size_t lane = 0; lane < sum_lanes; ++lane) {
    real += static_cast<double>(re[lane]);
    imaginary += static_cast<double>(im[lane]);
  }
  return {real, imaginary};
}

}  // namespace palpa::acoustics
