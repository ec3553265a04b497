#include "array/solvers/greedy.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/lanes.hpp"

namespace palpa::array {

std::uint32_t greedy_stride(std::uint32_t transducers) {
  if (transducers < 3) return 1;
  auto stride = static_cast<std::uint32_t>(std::lround(0.618 * transducers));
  while (std::gcd(stride, transducers) != 1)
    ++stride;
  return stride;
}

namespace {

using Phases = std::array<double, greedy_phases>;
using Foci = std::array<double, most_solved_foci>;

/// A transducer's sound at each focus, and what is there so far.
struct Choice {
  std::size_t foci;
  const Foci &give_re, &give_im, &energy, &re, &im, &size, &lacks;
  const Phases &cosine, &sine;
};

/// What each phase costs.
[[gnu::always_inline]] inline void cost_all(const Choice& choice, Phases& __restrict costs) {
  costs = {};
  for (std::size_t j = 0; j < choice.foci; ++j) {
    const double give_re = choice.give_re[j], give_im = choice.give_im[j], energy = choice.energy[j];
    const double re = choice.re[j], im = choice.im[j], size = choice.size[j], lacks = choice.lacks[j];
    for (std::uint32_t c = 0; c < greedy_phases; ++c) {
      const double x = give_re * choice.cosine[c] - give_im * choice.sine[c];
      const double y = give_re * choice.sine[c] + give_im * choice.cosine[c];
      // How much louder the focus becomes, |p + g'| - |p|, and how that changes the square. Differences of large
      // numbers would leave nothing to compare in single precision.
      const double new_re = re + x;
      const double new_im = im + y;
      const double sum = std::sqrt(new_re * new_re + new_im * new_im) + size;
      const double gained = (2 * (re * x + im * y) + energy) / std::max(sum, 1e-30);
      costs[c] += gained * (gained - 2 * lacks);
    }
  }
}

}  // namespace

void greedy(const Columns& columns, std::span<const double> gains, std::span<std::uint8_t> phases) {
  const std::size_t foci = columns.foci;
  assert(gains.size() == foci && phases.size() == columns.transducers && foci <= most_solved_foci);
  Phases cosine{}, sine{}, costs{};
  for (std::uint32_t c = 0; c < greedy_phases; ++c) {
    cosine[c] = std::cos(2 * std::numbers::pi * c / greedy_phases);
    sine[c] = std::sin(2 * std::numbers::pi * c / greedy_phases);
  }
  double squares = 0;
  for (const double gain : gains)
    squares += gain * gain;
  const double share = squares > 0 ? 1 / std::sqrt(squares) : 0;

  Foci re{}, im{}, size{}, give_re{}, give_im{}, energy{}, lacks{};
  const Choice choice{foci, give_re, give_im, energy, re, im, size, lacks, cosine, sine};
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
    std::size_t best = 0;
    if (done > 0) {  // for the first transducer, all phases are equivalent
      in_lanes([&](auto) PALPA_INLINED { cost_all(choice, costs); });
      best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
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
