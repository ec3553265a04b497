#include "array/solvers/search_lanes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "array/solvers/gs_pat.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Lanes = Lanes8;
using Float = Lanes::Float;
static_assert(Lanes::width == starts_together);

constexpr float least = 1e-30F;  // squares below this are 0

/// Factors and pressures of eight starts, by focus.
struct Starts {
  std::array<Float, most_searched_foci> re, im, best_re, best_im;
  Float merit;
};

[[gnu::always_inline]] inline Float all(float value) {
  return Float{value, value, value, value, value, value, value, value};
}
[[gnu::always_inline]] inline Float smaller(const Float& a, const Float& b) {
  return a < b ? a : b;
}

[[gnu::always_inline]] inline void hear(const SinglePart& part, const Starts& starts,
                                        std::array<Float, most_searched_foci>& re,
                                        std::array<Float, most_searched_foci>& im) {
  const std::size_t foci = part.foci;
  for (std::size_t j = 0; j < foci; ++j)
    re[j] = im[j] = all(0);
  for (std::size_t n = 0; n < part.transducers; ++n) {
    const SinglePart::Entry* const entries = &part.entries[n * foci];
    Float x = all(0), y = all(0);
    for (std::size_t j = 0; j < foci; ++j) {
      x += starts.re[j] * entries[j].b_re - starts.im[j] * entries[j].b_im;
      y += starts.re[j] * entries[j].b_im + starts.im[j] * entries[j].b_re;
    }
    const Float by = inverse_root<Lanes>(x * x + y * y + least);
    x *= by;
    y *= by;
    for (std::size_t j = 0; j < foci; ++j) {
      re[j] += x * entries[j].g_re - y * entries[j].g_im;
      im[j] += x * entries[j].g_im + y * entries[j].g_re;
    }
  }
}

[[gnu::always_inline]] inline void run_all(const SinglePart& part, const std::array<float, most_searched_foci>& claims,
                                           std::uint32_t steps, Starts& starts) {
  const std::size_t foci = part.foci;
  std::array<Float, most_searched_foci> re, im, size;
  float claimed = 0;
  for (std::size_t j = 0; j < foci; ++j)
    claimed += claims[j];
  starts.merit = all(-1);
  for (std::uint32_t step = 0; step <= steps; ++step) {
    hear(part, starts, re, im);
    Float weakest = all(1e30F), level = all(0);
    for (std::size_t j = 0; j < foci; ++j) {
      const Float square = re[j] * re[j] + im[j] * im[j] + least;
      const Float inverse = inverse_root<Lanes>(square);
      const Float loud = square * inverse;
      if (claims[j] > 0) weakest = smaller(weakest, loud * (1 / claims[j]));
      level += loud;
      re[j] *= inverse;  // from here on, the phases
      im[j] *= inverse;
      size[j] = loud;
    }
    const auto louder = weakest > starts.merit;
    starts.merit = louder ? weakest : starts.merit;
    for (std::size_t j = 0; j < foci; ++j) {
      starts.best_re[j] = louder ? starts.re[j] : starts.best_re[j];
      starts.best_im[j] = louder ? starts.im[j] : starts.best_im[j];
    }
    if (step == steps) return;
    level *= 1 / claimed;
    Float total = all(0);
    for (std::size_t j = 0; j < foci; ++j) {
      const Float before = starts.re[j] * starts.re[j] + starts.im[j] * starts.im[j] + least;
      size[j] = before * inverse_root<Lanes>(before) * smaller(claims[j] * level / size[j], all(4));
      total += size[j];
    }
    const Float scale = static_cast<float>(foci) / total;
    for (std::size_t j = 0; j < foci; ++j) {
      const Float next = smaller(size[j] * scale, all(static_cast<float>(gs_pat_most_weight)));
      starts.re[j] = re[j] * next;
      starts.im[j] = im[j] * next;
    }
  }
}

}  // namespace

void take_single(const Columns& columns, SinglePart& part) {
  part.foci = columns.foci;
  part.transducers = columns.transducers;
  part.entries.resize(columns.loud.size());
  // The loudness of the whole does not matter, but must be within single precision.
  double loudest = 0;
  for (const double loud : columns.loud)
    loudest = std::max(loudest, loud);
  const double scale = loudest > 0 ? 1 / loudest : 1;
  for (std::size_t e = 0; e < part.entries.size(); ++e) {
    const std::complex<double> g = scale * columns.transfer(e), b = columns.ask(e);
    part.entries[e] = {static_cast<float>(g.real()), static_cast<float>(g.imag()), static_cast<float>(b.real()),
                       static_cast<float>(b.imag())};
  }
}

void run_starts(const SinglePart& part, std::span<const double> claims, std::uint32_t steps,
                std::span<std::complex<double>> starts, std::span<double> merits) {
  const std::size_t foci = part.foci, count = merits.size();
  assert(count <= starts_together && foci <= most_searched_foci && starts.size() == count * foci);
  std::array<float, most_searched_foci> single{};
  for (std::size_t j = 0; j < foci; ++j)
    single[j] = static_cast<float>(claims[j]);
  Starts lanes;
  for (std::size_t j = 0; j < foci; ++j) {
    // Lanes without a start repeat the last one.
    for (std::size_t lane = 0; lane < starts_together; ++lane) {
      const std::complex<double>& factor = starts[std::min(lane, count - 1) * foci + j];
      lanes.re[j][lane] = static_cast<float>(factor.real());
      lanes.im[j][lane] = static_cast<float>(factor.imag());
    }
    lanes.best_re[j] = lanes.re[j];
    lanes.best_im[j] = lanes.im[j];
  }
  in_lanes([&](auto) PALPA_INLINED { run_all(part, single, steps, lanes); });
  for (std::size_t lane = 0; lane < count; ++lane) {
    merits[lane] = static_cast<double>(lanes.merit[lane]);
    for (std::size_t j = 0; j < foci; ++j)
      starts[lane * foci + j] = {static_cast<double>(lanes.best_re[j][lane]),
                                 static_cast<double>(lanes.best_im[j][lane])};
  }
}

}  // namespace palpa::array
