#include "array/free_drives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "array/field/turns.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t block = 64;  // transducers
using Values = std::array<double, block>;

/// The places of a block's transducers. Beyond the last transducer, the places repeat the last one.
struct Places {
  Values x, y, z;

  [[gnu::always_inline]] inline Places(const Layout& layout, std::size_t first) {
    for (std::size_t n = 0; n < block; ++n) {
      const Vec3& at = layout.transducers[std::min(first + n, layout.transducers.size() - 1)].position;
      x[n] = at.x;
      y[n] = at.y;
      z[n] = at.z;
    }
  }
  [[gnu::always_inline]] inline double square_to(std::size_t n, const Vec3& focus) const {
    const double dx = x[n] - focus.x, dy = y[n] - focus.y, dz = z[n] - focus.z;
    return dx * dx + dy * dy + dz * dz;
  }
};

/// The amplitude that a focus asks of a transducer: its distance over that of the farthest one, or 1. One formula for
/// both, because compilers do not vectorise a loop with a choice.
struct Asked {
  double slope, offset, farthest;

  Asked(const FocusSource& source, Weighting weighting)
      : slope(weighting == Weighting::uniform || source.farthest == 0 ? 0 : 1),
        offset(1 - slope),
        farthest(slope > 0 ? source.farthest : 1) {}
  [[gnu::always_inline]] inline double at(double distance) const { return (distance * slope + offset) / farthest; }
};

struct OneFocus {
  FocusSource source;
  Asked asked;
  double turns_per_metre;
};

[[gnu::always_inline]] inline void one(const Layout& layout, const OneFocus& focus, std::span<TransducerDrive> out) {
  for (std::size_t first = 0; first < out.size(); first += block) {
    const Places places(layout, first);
    std::array<float, block> amplitude, phase;
    for (std::size_t n = 0; n < block; ++n) {
      const double distance = std::sqrt(places.square_to(n, focus.source.position));
      const double turns = distance * focus.turns_per_metre;
      const double early = nearest(turns) - turns;  // -k d, within half a turn
      amplitude[n] = as_amplitude(focus.asked.at(distance) * focus.source.gain);
      phase[n] = as_phase(2 * std::numbers::pi * (early <= -0.5 ? early + 1 : early));
    }
    const std::size_t count = std::min(block, out.size() - first);
    for (std::size_t n = 0; n < count; ++n)
      out[first + n] = {amplitude[n], phase[n]};
  }
}

struct SeveralFoci {
  std::span<const FocusSource> sources;
  std::span<const FocusWeight> weights;
  Weighting weighting;
  double turns_per_metre;
};

/// Returns the largest squared magnitude.
[[gnu::always_inline]] inline double sum(const Layout& layout, const SeveralFoci& foci, std::span<Complex> sums) {
  Values largest{};
  for (std::size_t first = 0; first < sums.size(); first += block) {
    const Places places(layout, first);
    Values plain_re{}, plain_im{}, heard_re{}, heard_im{};
    for (std::size_t j = 0; j < foci.sources.size(); ++j) {
      const FocusSource& source = foci.sources[j];
      const Asked asked(source, foci.weighting);
      const Complex plain = foci.weights[j].plain, heard = foci.weights[j].heard;
      for (std::size_t n = 0; n < block; ++n) {
        const double distance = std::sqrt(places.square_to(n, source.position));
        double cosine, sine;
        wave_of_turns(distance * foci.turns_per_metre, cosine, sine);
        const double amplitude = asked.at(distance);
        const double re = amplitude * cosine, im = -amplitude * sine;
        plain_re[n] += plain.real() * re - plain.imag() * im;
        plain_im[n] += plain.real() * im + plain.imag() * re;
        heard_re[n] += heard.real() * re - heard.imag() * im;
        heard_im[n] += heard.real() * im + heard.imag() * re;
      }
    }
    for (std::size_t n = 0; n < block; ++n) {
      const double square = std::max(plain_re[n] * plain_re[n] + plain_im[n] * plain_im[n],
                                     heard_re[n] * heard_re[n] + heard_im[n] * heard_im[n]);
      largest[n] = std::max(largest[n], square);
    }
    const std::size_t count = std::min(block, sums.size() - first);
    for (std::size_t n = 0; n < count; ++n)
      sums[first + n] = {heard_re[n], heard_im[n]};
  }
  return *std::ranges::max_element(largest);
}

/// The angles of re + i im in radians, within 1e-11; 0 for 0. Uses the series of the arc tangent up to a sixteenth of a
/// turn; what is steeper is turned back by an eighth. Each loop stores its results, because compilers do not vectorise
/// the branches that they make of several choices.
[[gnu::always_inline]] inline void find_angles(const Values& re, const Values& im, Values& angle) {
  constexpr double sixteenth = 0.41421356237309503;  // its tangent, tan(pi / 8)
  Values longer, shorter, turned, steep, behind, empty;
  for (std::size_t n = 0; n < block; ++n) {
    longer[n] = std::max(std::abs(re[n]), std::abs(im[n]));
    shorter[n] = std::min(std::abs(re[n]), std::abs(im[n]));
  }
  for (std::size_t n = 0; n < block; ++n) {
    turned[n] = shorter[n] > sixteenth * longer[n] ? 1.0 : 0.0;
    steep[n] = std::abs(im[n]) > std::abs(re[n]) ? 1.0 : 0.0;
    behind[n] = re[n] < 0 ? 1.0 : 0.0;
    empty[n] = longer[n] > 0 ? 0.0 : 1.0;
  }
  for (std::size_t n = 0; n < block; ++n) {
    const double slope = (shorter[n] - turned[n] * longer[n]) / (longer[n] + turned[n] * shorter[n] + empty[n]);
    const double square = slope * slope;
    double series = 1.0 / 25;
    for (int odd = 23; odd > 0; odd -= 2)
      series = 1.0 / odd - series * square;
    const double low = slope * series + turned[n] * (std::numbers::pi / 4);
    const double right = steep[n] * (std::numbers::pi / 2) + (1 - 2 * steep[n]) * low;
    angle[n] = std::copysign(behind[n] * std::numbers::pi + (1 - 2 * behind[n]) * right, im[n]);
  }
}

struct Turned {
  double largest, gain;
};

[[gnu::always_inline]] inline void turn(std::span<const Complex> sums, const Turned& by,
                                        std::span<TransducerDrive> out) {
  for (std::size_t first = 0; first < out.size(); first += block) {
    const std::size_t count = std::min(block, out.size() - first);
    Values re{}, im{}, share, angle;
    for (std::size_t n = 0; n < count; ++n) {
      re[n] = sums[first + n].real();
      im[n] = sums[first + n].imag();
    }
    for (std::size_t n = 0; n < block; ++n)
      share[n] = std::min(std::sqrt(re[n] * re[n] + im[n] * im[n]) / by.largest, 1.0);  // NaN stays
    find_angles(re, im, angle);
    std::array<float, block> amplitude, phase;
    for (std::size_t n = 0; n < block; ++n) {
      amplitude[n] = as_amplitude(share[n] * by.gain);
      phase[n] = as_phase(angle[n]);
    }
    for (std::size_t n = 0; n < count; ++n)
      out[first + n] = {amplitude[n], phase[n]};
  }
}

[[gnu::always_inline]] inline double farthest(const Layout& layout, const Vec3& focus) {
  Values squares{};
  for (std::size_t first = 0; first < layout.transducers.size(); first += block) {
    const Places places(layout, first);
    for (std::size_t n = 0; n < block; ++n)
      squares[n] = std::max(squares[n], places.square_to(n, focus));
  }
  return std::sqrt(*std::ranges::max_element(squares));
}

}  // namespace

double farthest_distance(const Layout& layout, const Vec3& focus) {
  return in_lanes([&](auto) PALPA_INLINED { return farthest(layout, focus); });
}

void drive_focus_in_free_field(const Layout& layout, const FocusSource& source, Weighting weighting,
                               const Medium& medium, std::span<TransducerDrive> out) {
  const OneFocus focus{source, Asked(source, weighting), medium.turns_per_metre()};
  in_lanes([&](auto) PALPA_INLINED { one(layout, focus, out); });
}

double sum_foci_in_free_field(const Layout& layout, std::span<const FocusSource> sources,
                              std::span<const FocusWeight> weights, Weighting weighting, const Medium& medium,
                              std::span<Complex> sums) {
  const SeveralFoci foci{sources, weights, weighting, medium.turns_per_metre()};
  return std::sqrt(in_lanes([&](auto) PALPA_INLINED { return sum(layout, foci, sums); }));
}

void drive_sums(std::span<const Complex> sums, double largest, double gain, std::span<TransducerDrive> out) {
  in_lanes([&](auto) PALPA_INLINED { turn(sums, {largest, gain}, out); });
}

}  // namespace palpa::array
