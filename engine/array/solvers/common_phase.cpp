#include "array/solvers/common_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "array/turns.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t block = 64;  // transducers

struct Rounded {
  const SplitRows& nulls;
  std::span<const Complex> does;
  Complex turn;
  double steps;
};

/// The loudest null of the rounded drive.
[[gnu::always_inline]] inline double loudest(const Rounded& drive) {
  constexpr std::size_t most_rows = 64;
  std::array<double, most_rows> sum_re{}, sum_im{};
  const std::size_t rows = std::min(drive.nulls.rows, most_rows);
  for (std::size_t first = 0; first < drive.does.size(); first += block) {
    const std::size_t count = std::min(block, drive.does.size() - first);
    std::array<double, block> size{}, turns{}, re{}, im{};
    for (std::size_t n = 0; n < count; ++n) {
      const Complex& by = drive.does[first + n];
      const double x = by.real() * drive.turn.real() - by.imag() * drive.turn.imag();
      const double y = by.real() * drive.turn.imag() + by.imag() * drive.turn.real();
      size[n] = std::sqrt(x * x + y * y);
      turns[n] = std::atan2(y, x) * (0.5 / std::numbers::pi);
    }
    for (std::size_t n = 0; n < block; ++n) {
      double cosine, sine;
      wave_of_turns(nearest(turns[n] * drive.steps) / drive.steps, cosine, sine);
      re[n] = size[n] * cosine;
      im[n] = size[n] * sine;
    }
    for (std::size_t j = 0; j < rows; ++j) {
      const double* const g_re = &drive.nulls.re[j * drive.nulls.stride + first];
      const double* const g_im = &drive.nulls.im[j * drive.nulls.stride + first];
      for (std::size_t n = 0; n < count; ++n) {
        sum_re[j] += g_re[n] * re[n] - g_im[n] * im[n];
        sum_im[j] += g_re[n] * im[n] + g_im[n] * re[n];
      }
    }
  }
  double most = 0;
  for (std::size_t j = 0; j < rows; ++j)
    most = std::max(most, sum_re[j] * sum_re[j] + sum_im[j] * sum_im[j]);
  return std::sqrt(most);
}
double loudest_plain(const Rounded& drive) {
  return loudest(drive);
}
PALPA_AVX2 double loudest_avx2(const Rounded& drive) {
  return loudest(drive);
}

Complex turn_of(std::uint32_t number) {
  const double turns = static_cast<double>(number) / (common_phases * roundings[0].steps);
  double cosine, sine;
  wave_of_turns(turns, cosine, sine);
  return {cosine, sine};
}

}  // namespace

void choose_common_phase(const SplitRows& nulls, double weakest_focus, std::span<Complex> does) {
  if (nulls.rows == 0 || !(weakest_focus > 0)) return;
  // The largest part of what a null may have, over all roundings.
  const auto worst_of = [&](std::uint32_t number, double enough) {
    double worst = 0;
    for (const Rounding& rounding : roundings) {
      const double heard = (has_avx2() ? loudest_avx2 : loudest_plain)(
          {nulls, does, turn_of(number), static_cast<double>(rounding.steps)});
      worst = std::max(worst, heard / (rounding.depth * weakest_focus));
      if (worst >= enough) break;
    }
    return worst;
  };
  double best = worst_of(0, 1e300);
  std::uint32_t chosen = 0;
  for (std::uint32_t number = 1; number < common_phases && best > 1; ++number) {
    if (const double worst = worst_of(number, best); worst < best) {
      best = worst;
      chosen = number;
    }
  }
  if (chosen == 0) return;
  const Complex by = turn_of(chosen);
  for (Complex& one : does)
    one = {one.real() * by.real() - one.imag() * by.imag(), one.real() * by.imag() + one.imag() * by.real()};
}

}  // namespace palpa::array
