#include "observer/afferents/response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/lanes.hpp"
#include "observer/afferents/half_space.hpp"

namespace palpa::observer {
namespace {

constexpr std::size_t lanes = 4;
using Lane4 [[gnu::vector_size(32)]] = double;
using Bits4 [[gnu::vector_size(32)]] = long long;

[[gnu::always_inline]] inline Lane4 positive(const Lane4& x) {
  const Lane4 zero{};
  return reinterpret_cast<Lane4>(reinterpret_cast<Bits4>(x) & reinterpret_cast<Bits4>(x > zero));
}

[[gnu::always_inline]] inline bool any(const Bits4& bits) {
  return (bits[0] | bits[1] | bits[2] | bits[3]) != 0;
}

/// A third-order low-pass filter, transposed direct form II.
struct Coefficients {
  double b[4], a[4];
};

/// Butterworth's filter by the bilinear transform: the analogue 1 / ((s + 1)(s^2 + s + 1)) with s = (z - 1) / (g (z +
/// 1)), g = tan(pi cutoff / rate).
Coefficients butterworth(double cutoff_hz) {
  const double g = std::tan(std::numbers::pi * cutoff_hz / afferent_rate_hz);
  // (1 + g) z + (g - 1), and (1 + g + g^2) z^2 + 2 (g^2 - 1) z + (1 - g + g^2).
  const double p = 1 + g, q = g - 1, r = 1 + g + g * g, s = 2 * (g * g - 1), t = 1 - g + g * g;
  const double a0 = p * r, b = g * g * g / a0;
  return {{b, 3 * b, 3 * b, b}, {1, (p * s + q * r) / a0, (p * t + q * s) / a0, q * t / a0}};
}

struct Filter {
  Lane4 z1{}, z2{}, z3{};
  [[gnu::always_inline]] inline Lane4 step(const Coefficients& c, const Lane4& x) {
    const Lane4 y = c.b[0] * x + z1;
    z1 = c.b[1] * x - c.a[1] * y + z2;
    z2 = c.b[2] * x - c.a[2] * y + z3;
    z3 = c.b[3] * x - c.a[3] * y;
    return y;
  }
};

constexpr std::uint32_t after_samples = 190, least_gap = 5;

/// The current in each sample after a spike, and 0 in the end.
std::array<double, after_samples + 1> after_spike(const AfferentModel& model) {
  const double k = 3 * std::numbers::pi / (4 * std::log(3.0));
  const auto bump = [&](double n, double centre) {
    return (1 + std::cos(std::min(std::numbers::pi, k * std::abs(std::log((n + 5) / centre))))) / 2;
  };
  std::array<double, after_samples + 1> h{};
  for (std::uint32_t n = 0; n < after_samples; ++n)
    h[n] = model.after_quick * bump(n, 5) + model.after_slow * bump(n, 45);
  return h;
}

struct Block {
  const double *stress, *velocity;  // four sites side by side
  std::size_t samples, from, sites, first;
};

[[gnu::always_inline]] inline Lane4 load(const double* from) {
  Lane4 value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

[[gnu::always_inline]] inline void respond_block(const Block& in, const AfferentModel& m, double level,
                                                 const Coefficients& filter,
                                                 const std::array<double, after_samples + 1>& after, Spikes& out) {
  const double depth = depth_mm(m.kind), dynamic = level * skin_stiffness / (depth * depth), leak = 1 - 1 / m.memory;
  const bool stressed = m.stress_up != 0 || m.stress_down != 0, saturates = m.saturation > 0;
  const Lane4 limit{m.saturation, m.saturation, m.saturation, m.saturation};
  Filter of_stress, of_rate;
  std::uint32_t since[lanes] = {after_samples, after_samples, after_samples, after_samples};
  bool resting = true;
  Lane4 v{}, rate = of_rate.step(filter, load(in.velocity) * dynamic);
  for (std::size_t n = 0; n < in.samples; ++n) {
    const Lane4 next = n + 1 < in.samples ? of_rate.step(filter, load(in.velocity + (n + 1) * lanes) * dynamic) : rate;
    const Lane4 change = next - rate;
    Lane4 current = m.rate_up * positive(rate) + m.rate_down * positive(-rate) + m.change_up * positive(change) +
                    m.change_down * positive(-change);
    if (stressed) {
      const Lane4 s = of_stress.step(filter, load(in.stress + n * lanes) * level);
      current += m.stress_up * positive(s) + m.stress_down * positive(-s);
    }
    if (saturates) current = limit * current / (limit + positive(current) + positive(-current));
    rate = next;
    // Most of the time nothing fires, and the last spikes are too long ago to matter.
    if (resting) {
      v = v * leak + current;
      if (!any(v > 1)) continue;
    } else {
      const Lane4 h{after[since[0]], after[since[1]], after[since[2]], after[since[3]]};
      v = v * leak + current + h;
      resting = true;
      for (std::uint32_t& s : since) {
        s = std::min(s + 1, after_samples);
        resting = resting && s == after_samples;
      }
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      if (!(v[i] > 1) || since[i] <= least_gap) continue;
      v[i] = 0;
      since[i] = 0;
      resting = false;
      if (i >= in.sites) continue;
      if (n >= in.from) ++out.counts[in.first + i];
      if (!out.times.empty()) out.times[in.first + i].push_back(static_cast<double>(n + 1) / afferent_rate_hz);
    }
  }
}

}  // namespace

SiteSignal::SiteSignal(std::size_t sites, std::size_t samples)
    : sites_(sites), samples_(samples), values_((sites + 3) / 4 * 4 * samples) {}

Spikes respond(const SkinMotion& motion, const AfferentModel& model, double level, std::size_t from, SpikeTimes times) {
  Spikes out;
  const SiteSignal& velocity = motion.velocity;
  out.counts.resize(velocity.sites());
  if (times == SpikeTimes::yes) out.times.resize(velocity.sites());
  if (velocity.samples() == 0) return out;
  const Coefficients filter = butterworth(model.cutoff_hz);
  const auto after = after_spike(model);
  for (std::size_t b = 0; b < velocity.blocks(); ++b) {
    const std::size_t first = b * lanes, sites = std::min(lanes, velocity.sites() - first);
    const Block block{motion.stress.block(b), velocity.block(b), velocity.samples(), from, sites, first};
    in_lanes([&](auto) PALPA_INLINED { respond_block(block, model, level, filter, after, out); });
  }
  return out;
}

}  // namespace palpa::observer
