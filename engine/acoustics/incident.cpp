#include "acoustics/incident.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/activity.hpp"
#include "base/parallel.hpp"

namespace palpa::acoustics {

using array::Layout;
using array::Transducer;
using Complex = std::complex<double>;

namespace {

/// Points looked at in one go. Every loop over them is plain arithmetic on arrays of this length, so that compilers
/// make vector instructions of it.
constexpr std::size_t width = 64;
/// Transducers whose parts are summed in single precision before they go into the double sum.
constexpr std::size_t batch = 128;

template <typename T>
using Lanes = std::array<T, width>;

/// Rounds to the nearest whole number, up to 2^51 and 2^22.
double nearest(double x) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + shift) - shift;
}
float nearest(float x) {
  constexpr float shift = 12582912.0F;  // 1.5 * 2^23
  return (x + shift) - shift;
}

/// sin(2 pi x) for x in -1/4..1/4, within 1e-7. Twin: shaders/turns.glsl.
float sine_of_turns(float x) {
  const float y = x * 6.2831853F;
  const float s = y * y;
  float series = -2.5052108e-8F;
  series = series * s + 2.7557319e-6F;
  series = series * s - 1.9841270e-4F;
  series = series * s + 8.3333333e-3F;
  series = series * s - 1.6666667e-1F;
  series = series * s + 1.0F;
  return y * series;
}

/// e^{-x} for x in 0..80, within 2e-7 of it; e^{-80} beyond.
float fading(float x) {
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

}  // namespace

/// Some of the points. Where there are fewer than `width`, the last one stands in for the rest.
struct Incident::Block {
  Lanes<double> x, y, z;
  Lanes<float> nx, ny, nz;
  std::size_t count;

  Block(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t first)
      : count(std::min(width, points.size() - first)) {
    for (std::size_t i = 0; i < width; ++i) {
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
};

/// G of one transducer, and its slope, at a block's points.
struct Incident::Transfer {
  Lanes<float> re, im, slope_re, slope_im;
};

Incident::Incident(const Layout& layout, const Air& air, array::Directivity directivity) : layout_(layout), air_(air) {
  const std::vector<double> table =
      array::directivity_table(directivity, air.wave_number() * layout.transducer_radius_m);
  for (std::size_t i = 0; i + 1 < table.size(); ++i)
    table_.push_back({static_cast<float>(table[i]), static_cast<float>(table[i + 1] - table[i])});
}

void Incident::transfer(const Transducer& from, const Block& to, bool slopes, Transfer& out) const {
  constexpr auto steps = static_cast<float>(array::directivity_steps);
  const double turns_per_metre = air_.medium.turns_per_metre();
  const auto ax = static_cast<float>(from.axis.x), ay = static_cast<float>(from.axis.y),
             az = static_cast<float>(from.axis.z);
  // At the transducer itself there is no direction; nothing is divided by less than this.
  const float closest = std::max(static_cast<float>(layout_.transducer_radius_m), 1e-9F);
  const auto alpha = static_cast<float>(air_.absorption_np_m);
  const auto k = static_cast<float>(air_.wave_number());

  // From the transducer to the point: unit vector, distance, and what is left of it beyond whole wavelengths.
  Lanes<float> x, y, z, distance, turns;
  for (std::size_t i = 0; i < width; ++i) {
    const double dx = to.x[i] - from.position.x, dy = to.y[i] - from.position.y, dz = to.z[i] - from.position.z;
    const double d = std::sqrt(dx * dx + dy * dy + dz * dz);
    const double all = d * turns_per_metre;
    turns[i] = static_cast<float>(all - nearest(all));
    distance[i] = static_cast<float>(d);
    x[i] = static_cast<float>(dx);
    y[i] = static_cast<float>(dy);
    z[i] = static_cast<float>(dz);
  }
  Lanes<float> slant, inverse, loud, rise;
  for (std::size_t i = 0; i < width; ++i) {
    inverse[i] = 1 / std::max(distance[i], 1e-9F);
    slant[i] = (x[i] * ax + y[i] * ay + z[i] * az) * inverse[i];
    // At the transducer itself as on its axis.
    slant[i] = distance[i] > 0 ? slant[i] : 1.0F;
  }
  for (std::size_t i = 0; i < width; ++i) {
    const float place = std::clamp((slant[i] + 1) * (0.5F * steps), 0.0F, steps);
    const auto step = std::min(static_cast<std::int32_t>(place), static_cast<std::int32_t>(steps) - 1);
    const Entry& entry = table_[static_cast<std::size_t>(step)];
    loud[i] = entry.value + entry.rise * (place - static_cast<float>(step));
    rise[i] = entry.rise * (0.5F * steps);
  }
  for (std::size_t i = 0; i < width; ++i) {
    const float near = 1 / std::max(distance[i], closest) * fading(alpha * distance[i]);
    loud[i] *= near;
    rise[i] *= near;
  }
  Lanes<float> cosine, sine;
  for (std::size_t i = 0; i < width; ++i) {
    const float size = std::abs(turns[i]);
    // A quarter of a turn on either side of the steep part of each curve.
    cosine[i] = sine_of_turns(0.25F - size);
    sine[i] = std::copysign(sine_of_turns(0.25F - std::abs(0.25F - size)), turns[i]);
    out.re[i] = loud[i] * cosine[i];
    out.im[i] = loud[i] * sine[i];
  }
  if (!slopes) return;
  for (std::size_t i = 0; i < width; ++i) {
    const float along = (x[i] * to.nx[i] + y[i] * to.ny[i] + z[i] * to.nz[i]) * inverse[i];
    const float axis = ax * to.nx[i] + ay * to.ny[i] + az * to.nz[i];
    const float spread = distance[i] > closest ? alpha + inverse[i] : alpha;
    const float grows = rise[i] * (axis - slant[i] * along) * inverse[i] - spread * along * loud[i];
    const float turn = k * along * loud[i];
    out.slope_re[i] = grows * cosine[i] - turn * sine[i];
    out.slope_im[i] = grows * sine[i] + turn * cosine[i];
  }
}

Strengths strengths_of(std::span<const array::TransducerDrive> drive) {
  Strengths strengths(drive.size());
  std::ranges::transform(drive, strengths.begin(), [](const array::TransducerDrive& d) {
    return std::polar(static_cast<double>(d.amplitude), static_cast<double>(d.phase));
  });
  return strengths;
}

namespace {

/// One drive's sum over transducers at a block's points: of a batch in single precision, of all batches in double.
struct Sum {
  Lanes<float> re{}, im{};
  Lanes<double> all_re{}, all_im{};

  void add(std::complex<float> s, const Lanes<float>& g_re, const Lanes<float>& g_im) {
    const float a = s.real(), b = s.imag();
    for (std::size_t i = 0; i < width; ++i) {
      re[i] += a * g_re[i] - b * g_im[i];
      im[i] += a * g_im[i] + b * g_re[i];
    }
  }
  void end_batch() {
    for (std::size_t i = 0; i < width; ++i) {
      all_re[i] += static_cast<double>(re[i]);
      all_im[i] += static_cast<double>(im[i]);
      re[i] = im[i] = 0;
    }
  }
  void store(double level, std::span<Complex> into) const {
    for (std::size_t i = 0; i < into.size(); ++i)
      into[i] = level * Complex(all_re[i], all_im[i]);
  }
};

}  // namespace

bool Incident::at(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const Complex> strengths,
                  Waves& waves, const std::atomic<bool>* give_up) const {
  const std::size_t transducers = layout_.transducers.size();
  const std::size_t drives = transducers == 0 ? 0 : strengths.size() / transducers;
  const bool sloped = !normals.empty();
  assert(strengths.size() == drives * transducers && (!sloped || normals.size() == points.size()));
  waves.pressures.assign(drives * points.size(), 0);
  waves.slopes.assign(sloped ? drives * points.size() : 0, 0);
  if (drives == 0) return true;

  Activity activity("sums the sound of transducers", points.size());
  parallel_chunks(points.size(), width, [&](std::size_t, std::size_t begin, std::size_t) {
    if (give_up && *give_up) return;
    const Block block(points, normals, begin);
    Transfer transfer;
    std::vector<Sum> pressures(drives), slopes(sloped ? drives : 0);
    for (std::size_t t = 0; t < transducers; ++t) {
      this->transfer(layout_.transducers[t], block, sloped, transfer);
      for (std::size_t d = 0; d < drives; ++d) {
        const std::complex<float> s(strengths[d * transducers + t]);
        pressures[d].add(s, transfer.re, transfer.im);
        if (sloped) slopes[d].add(s, transfer.slope_re, transfer.slope_im);
      }
      if ((t + 1) % batch != 0 && t + 1 != transducers) continue;
      for (std::vector<Sum>* sums : {&pressures, &slopes}) {
        for (Sum& sum : *sums)
          sum.end_batch();
      }
    }
    for (std::size_t d = 0; d < drives; ++d) {
      const std::size_t first = d * points.size() + begin;
      pressures[d].store(layout_.source_level_pa_m, std::span(waves.pressures).subspan(first, block.count));
      if (sloped) slopes[d].store(layout_.source_level_pa_m, std::span(waves.slopes).subspan(first, block.count));
    }
    activity.advance(block.count);
  });
  return !(give_up && *give_up);
}

namespace {

Complex product(std::span<const Complex> weights, const Lanes<float>& g_re, const Lanes<float>& g_im) {
  double re = 0, im = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double a = weights[i].real(), b = weights[i].imag(), c = g_re[i], d = g_im[i];
    re += a * c - b * d;
    im += a * d + b * c;
  }
  return {re, im};
}

}  // namespace

bool Incident::received(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const Complex> strengths,
                        std::span<const Complex> slopes, std::vector<Complex>& received,
                        const std::atomic<bool>* give_up) const {
  const std::size_t transducers = layout_.transducers.size(), count = points.size();
  const std::size_t rows = count == 0 ? 0 : strengths.size() / count;
  const bool sloped = !slopes.empty();
  assert(strengths.size() == rows * count && (!sloped || (slopes.size() == rows * count && normals.size() == count)));
  received.assign(rows * transducers, 0);

  std::vector<Block> blocks;
  for (std::size_t first = 0; first < count; first += width)
    blocks.emplace_back(points, normals, first);
  // Each thread has transducers of its own, and adds up the points in their order.
  Activity activity("sums the sound at transducers", transducers);
  parallel_chunks(transducers, 16, [&](std::size_t, std::size_t begin, std::size_t end) {
    if (give_up && *give_up) return;
    Transfer transfer;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      for (std::size_t t = begin; t < end; ++t) {
        this->transfer(layout_.transducers[t], blocks[b], sloped, transfer);
        for (std::size_t row = 0; row < rows; ++row) {
          const std::size_t first = row * count + b * width;
          Complex sum = product(strengths.subspan(first, blocks[b].count), transfer.re, transfer.im);
          if (sloped) sum += product(slopes.subspan(first, blocks[b].count), transfer.slope_re, transfer.slope_im);
          received[row * transducers + t] += layout_.source_level_pa_m * sum;
        }
      }
    }
    activity.advance(end - begin);
  });
  return !(give_up && *give_up);
}

}  // namespace palpa::acoustics
