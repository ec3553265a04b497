#include "array/pressures/many_foci.hpp"

#include <algorithm>
#include <cmath>

#include "array/solvers/gs_pat.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// The factor for the pressure at a focus so that it stays within its limit.
double room(const SlotFocus& focus, const Complex& heard, const Layout& layout) {
  if (!focus.most_pa || !drivable(focus)) return 1;
  const double pascals = layout.source_level_pa_m * std::abs(heard);
  return pascals > *focus.most_pa ? *focus.most_pa / pascals : 1;
}

/// Lowers each finger by the smallest room() of its foci.
bool lower_fingers(std::span<const SlotFocus> foci, const Layout& layout, std::span<const Complex> heard,
                   std::span<Complex> factors) {
  bool lowered = false;
  for (std::size_t first = 0, end = 0; first < foci.size(); first = end) {
    double least = 1;
    for (end = first; end < foci.size() && foci[end].voice == foci[first].voice; ++end)
      least = std::min(least, room(foci[end], heard[end], layout));
    for (std::size_t j = first; j < end; ++j)
      factors[j] *= least;
    lowered = lowered || least < 1;
  }
  return lowered;
}

}  // namespace

std::size_t part_end(std::span<const SlotFocus> foci, std::size_t first) {
  if (foci.size() <= most_solved_foci) return foci.size();
  const std::size_t last = std::min(foci.size(), first + most_solved_foci);
  if (last == foci.size()) return last;
  std::size_t end = last;
  while (end > first && foci[end].voice == foci[end - 1].voice)
    --end;
  return end > first ? end : last;
}

void hear_all(const Transfer& transfer, const Layout& layout, std::span<const FocusSource> sources, Weighting weighting,
              std::span<const Complex> factors, Columns& columns, std::span<Complex> heard) {
  std::ranges::fill(heard, Complex(0));
  const std::size_t transducers = layout.transducers.size(), foci = sources.size();
  if (foci == 0) return;
  const std::size_t at_once = std::max<std::size_t>(1, most_solved_foci * transducers / foci);
  for (std::size_t first = 0; first < transducers; first += at_once) {
    const std::size_t count = std::min(at_once, transducers - first);
    transfer.fill(sources, weighting, first, count, columns);
    for (std::size_t n = 0; n < count; ++n) {
      Complex sum = 0;
      for (std::size_t j = 0; j < foci; ++j)
        sum += factors[j] * columns.ask(n * foci + j);
      for (std::size_t j = 0; j < foci; ++j)
        heard[j] += columns.transfer(n * foci + j) * sum;
    }
  }
}

void keep_below(const Transfer& transfer, const Layout& layout, std::span<const SlotFocus> foci,
                std::span<const FocusSource> sources, Weighting weighting, std::span<Complex> factors, Columns& columns,
                std::span<Complex> heard) {
  hear_all(transfer, layout, sources, weighting, factors, columns, heard);
  if (!lower_fingers(foci, layout, heard, factors)) return;
  hear_all(transfer, layout, sources, weighting, factors, columns, heard);
  double least = 1;
  for (std::size_t j = 0; j < foci.size(); ++j)
    least = std::min(least, room(foci[j], heard[j], layout));
  for (std::size_t j = 0; j < foci.size(); ++j) {
    factors[j] *= least;
    heard[j] *= least;
  }
}

void cap_unasked(const FocusMatrix& matrix, std::span<const SlotFocus> foci, std::span<double> targets) {
  for (std::size_t j = 0; j < targets.size(); ++j) {
    if (foci[j].most_pa) continue;
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (!foci[k].most_pa || !(targets[k] > 0)) continue;
      const double near = (heard_part(matrix, j, k) - gs_pat_crowded) / (1 - gs_pat_crowded);
      if (near > 0) targets[j] = std::min(targets[j], targets[k] / near);
    }
  }
}

void release_unasked(std::span<const SlotFocus> foci, std::span<double> targets) {
  for (std::size_t j = 0; j < targets.size(); ++j) {
    if (!foci[j].most_pa) targets[j] = 0;
  }
}

}  // namespace palpa::array
