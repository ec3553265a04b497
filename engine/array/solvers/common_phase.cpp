#include "array/solvers/common_phase.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "array/field/turns.hpp"
#include "array/layouts/board_types.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t block = 64;  // transducers
constexpr std::size_t most_rows = 64;

/// A drive, turned and rounded.
struct Rounded {
  const SplitRows& nulls;
  std::span<const double> size, turns;
  double turned, steps;
};

/// The loudest null of the rounded drive.
[[gnu::always_inline]] inline double loudest(const Rounded& drive) {
  std::array<double, most_rows> sum_re{}, sum_im{};
  for (std::size_t first = 0; first < drive.size.size(); first += block) {
    const std::size_t count = std::min(block, drive.size.size() - first);
    std::array<double, block> turns{}, re{}, im{};
    for (std::size_t n = 0; n < count; ++n)
      turns[n] = drive.turns[first + n];
    for (std::size_t n = 0; n < block; ++n)
      wave_of_turns(nearest((turns[n] + drive.turned) * drive.steps) / drive.steps, re[n], im[n]);
    for (std::size_t n = 0; n < count; ++n) {
      re[n] *= drive.size[first + n];
      im[n] *= drive.size[first + n];
    }
    for (std::size_t j = 0; j < drive.nulls.rows; ++j) {
      const double* const g_re = &drive.nulls.re[j * drive.nulls.stride + first];
      const double* const g_im = &drive.nulls.im[j * drive.nulls.stride + first];
      std::array<double, 4> x{}, y{};
      for (std::size_t n = 0; n < count; ++n) {
        x[n % 4] += g_re[n] * re[n] - g_im[n] * im[n];
        y[n % 4] += g_re[n] * im[n] + g_im[n] * re[n];
      }
      sum_re[j] += (x[0] + x[1]) + (x[2] + x[3]);
      sum_im[j] += (y[0] + y[1]) + (y[2] + y[3]);
    }
  }
  double most = 0;
  for (std::size_t j = 0; j < drive.nulls.rows; ++j)
    most = std::max(most, sum_re[j] * sum_re[j] + sum_im[j] * sum_im[j]);
  return std::sqrt(most);
}

double turn_of(std::uint32_t number) {
  const BoardType& coarsest = *std::ranges::min_element(board_types(), {}, &BoardType::phase_steps);
  return static_cast<double>(number) / (common_phases * coarsest.phase_steps);
}

}  // namespace

void choose_common_phase(const SplitRows& nulls, double weakest_focus, std::span<Complex> drive,
                         RoundingScratch& scratch) {
  assert(nulls.rows <= most_rows);
  if (nulls.rows == 0 || !(weakest_focus > 0)) return;
  scratch.size.resize(drive.size());
  scratch.turns.resize(drive.size());
  for (std::size_t n = 0; n < drive.size(); ++n) {
    scratch.size[n] = std::sqrt(std::norm(drive[n]));
    scratch.turns[n] = std::atan2(drive[n].imag(), drive[n].real()) * (0.5 / std::numbers::pi);
  }
  // The largest part of what a null may have, over all types of boards.
  const auto worst_of = [&](std::uint32_t number, double enough) {
    double worst = 0;
    for (const BoardType& type : board_types()) {
      const Rounded rounded{nulls, scratch.size, scratch.turns, turn_of(number), static_cast<double>(type.phase_steps)};
      const double heard = in_lanes([&](auto) PALPA_INLINED { return loudest(rounded); });
      worst = std::max(worst, heard / (type.null_depth * weakest_focus));
      if (worst >= enough) break;
    }
    return worst;
  };
  double best = worst_of(0, std::numeric_limits<double>::infinity());
  std::uint32_t chosen = 0;
  for (std::uint32_t number = 1; number < common_phases && best > 1; ++number) {
    if (const double worst = worst_of(number, best); worst < best) {
      best = worst;
      chosen = number;
    }
  }
  if (chosen == 0) return;
  double cosine, sine;
  wave_of_turns(turn_of(chosen), cosine, sine);
  for (Complex& one : drive)
    one = {one.real() * cosine - one.imag() * sine, one.real() * sine + one.imag() * cosine};
}

}  // namespace palpa::array
