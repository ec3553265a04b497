#include "array/solvers/greedy.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

namespace palpa::array {

std::uint32_t greedy_stride(std::uint32_t transducers) {
  if (transducers < 3) return 1;
  auto stride = static_cast<std::uint32_t>(std::lround(0.618 * transducers));
  while (std::gcd(stride, transducers) != 1)
    ++stride;
  return stride;
}

void greedy(const Columns& columns, std::span<const double> gains, std::span<std::uint8_t> phases) {
  const std::size_t foci = columns.foci;
  assert(gains.size() == foci && phases.size() == columns.transducers && foci <= most_solved_foci);
  std::array<double, greedy_phases> cosine{}, sine{};
  for (std::uint32_t c = 0; c < greedy_phases; ++c) {
    cosine[c] = std::cos(2 * std::numbers::pi * c / greedy_phases);
    sine[c] = std::sin(2 * std::numbers::pi * c / greedy_phases);
  }
  double squares = 0;
  for (const double gain : gains)
    squares += gain * gain;
  const double share = squares > 0 ? 1 / std::sqrt(squares) : 0;

  std::array<double, most_solved_foci> re{}, im{}, size{}, give_re{}, give_im{}, energy{}, lacks{};
  const auto transducers = static_cast<std::uint32_t>(columns.transducers);
  const std::uint32_t stride = greedy_stride(transducers);
  double level = 0;
  std::uint32_t n = 0;
  for (std::uint32_t done = 0; done < transducers; ++done, n = (n + stride) % transducers) {
    double total = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      give_re[j] = columns.loud[entry] * columns.cosine[entry];
      give_im[j] = columns.loud[entry] * columns.sine[entry];
      energy[j] = columns.loud[entry] * columns.loud[entry];
      total += energy[j];
    }
    level += std::sqrt(total / static_cast<double>(foci));
    for (std::size_t j = 0; j < foci; ++j)
      lacks[j] = gains[j] * share * level - size[j];
    std::uint32_t best = 0;
    double least = 0;
    // For the first transducer, all phases are equivalent.
    for (std::uint32_t c = 0; c < (done == 0 ? 1 : greedy_phases); ++c) {
      double cost = 0;
      for (std::size_t j = 0; j < foci; ++j) {
        const double x = give_re[j] * cosine[c] - give_im[j] * sine[c];
        const double y = give_re[j] * sine[c] + give_im[j] * cosine[c];
        // How much louder the focus becomes, |p + g'| - |p|, and how that changes the square. Differences of large
        // numbers would leave nothing to compare in single precision.
        const double new_re = re[j] + x;
        const double new_im = im[j] + y;
        const double sum = std::sqrt(new_re * new_re + new_im * new_im) + size[j];
        const double gained = (2 * (re[j] * x + im[j] * y) + energy[j]) / std::max(sum, 1e-30);
        cost += gained * (gained - 2 * lacks[j]);
      }
      if (c == 0 || cost < least) {
        least = cost;
        best = c;
      }
    }
    for (std::size_t j = 0; j < foci; ++j) {
      re[j] += give_re[j] * cosine[best] - give_im[j] * sine[best];
      im[j] += give_re[j] * sine[best] + give_im[j] * cosine[best];
      size[j] = std::sqrt(re[j] * re[j] + im[j] * im[j]);
    }
    phases[n] = static_cast<std::uint8_t>(best);
  }
}

}  // namespace palpa::array
