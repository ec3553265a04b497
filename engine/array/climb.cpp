#include "array/climb.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "array/greedy.hpp"
#include "array/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Products are written out, because those of std::complex check for infinities.
void listen(const Columns& columns, std::span<const Complex> does, std::span<Complex> pressure) {
  const std::size_t foci = columns.foci;
  std::array<double, most_solved_foci> re{}, im{};
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const double x = does[n].real(), y = does[n].imag();
    for (std::size_t j = 0; j < foci; ++j) {
      const std::size_t entry = n * foci + j;
      re[j] += columns.loud[entry] * (x * columns.cosine[entry] - y * columns.sine[entry]);
      im[j] += columns.loud[entry] * (x * columns.sine[entry] + y * columns.cosine[entry]);
    }
  }
  for (std::size_t j = 0; j < foci; ++j)
    pressure[j] = {re[j], im[j]};
}

/// sum over j of pull_j G_jn.
Complex pulled(const Columns& columns, std::size_t n, std::span<const Complex> pull) {
  double re = 0, im = 0;
  for (std::size_t j = 0; j < columns.foci; ++j) {
    const std::size_t entry = n * columns.foci + j;
    const double x = columns.loud[entry] * columns.cosine[entry], y = columns.loud[entry] * columns.sine[entry];
    re += pull[j].real() * x - pull[j].imag() * y;
    im += pull[j].real() * y + pull[j].imag() * x;
  }
  return {re, im};
}

double weakest_of(std::span<const double> loud, std::span<const std::uint8_t> counts) {
  double least = -1;
  for (std::size_t j = 0; j < loud.size(); ++j) {
    if (counts[j]) least = least < 0 ? loud[j] : std::min(least, loud[j]);
  }
  return std::max(least, 0.0);
}

/// The squares of the foci's distances from the level.
double unevenness(std::span<const double> loud, std::span<const std::uint8_t> counts, double level) {
  double sum = 0;
  for (std::size_t j = 0; j < loud.size(); ++j) {
    if (counts[j]) sum += (loud[j] - level) * (loud[j] - level);
  }
  return sum;
}

/// One climb. Its state is that of the scratch.
class Climb {
 public:
  Climb(const Columns& columns, std::span<const double> targets, const ClimbEffort& effort, std::span<double> shares,
        std::span<Complex> does, ClimbScratch& scratch)
      : columns_(columns), targets_(targets), effort_(effort), shares_(shares), does_(does), s_(scratch) {}

  double run() {
    listen(columns_, does_, s_.pressure);
    find_loudness(s_.pressure, s_.loud);
    begin_shares();
    if (std::ranges::none_of(s_.counts, [](std::uint8_t counts) { return counts != 0; })) return 0;
    for (const double sharpness : climb_sharpness)
      rise(sharpness, effort_.soft_steps);
    rise(0, effort_.steps);
    double weakest = weakest_of(s_.loud, s_.counts);
    if (effort_.lowerings > 0) lower(weakest);
    return weakest;
  }

 private:
  void find_loudness(std::span<const Complex> pressure, std::span<double> loud) const {
    for (std::size_t j = 0; j < targets_.size(); ++j)
      loud[j] = s_.counts[j] ? magnitude(pressure[j]) / targets_[j] : 0;
  }
  void begin_shares() {
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < shares_.size(); ++j) {
      shares_[j] = s_.counts[j] ? std::max(0.0, shares_[j]) : 0;
      sum += shares_[j];
      count += s_.counts[j];
    }
    for (std::size_t j = 0; j < shares_.size(); ++j)
      shares_[j] = sum > 0 ? shares_[j] / sum : s_.counts[j] / std::max(count, 1.0);
  }
  /// z_j / t_j u_j*
  void find_pull(std::span<const double> shares, std::span<Complex> pull) const {
    for (std::size_t j = 0; j < shares.size(); ++j) {
      const double heard = magnitude(s_.pressure[j]);
      pull[j] = s_.counts[j] && heard > 0 ? std::conj(s_.pressure[j]) * (shares[j] / (targets_[j] * heard)) : 0;
    }
  }

  /// D_n without the drive: what `stiff_pull` gives, and the part that all transducers have.
  double stiffness_of(std::size_t n) const {
    return magnitude(pulled(columns_, n, s_.stiff_pull)) * magnitude(does_[n]) + soft_;
  }

  /// K, from the pressure as it is.
  void find_growth() {
    const std::size_t foci = columns_.foci;
    find_pull(shares_, s_.stiff_pull);
    double sum = 0;
    for (std::size_t j = 0; j < foci; ++j)
      sum += shares_[j] * s_.loud[j];
    soft_ = std::max(climb_soft * sum / static_cast<double>(columns_.transducers), 1e-30);
    for (std::size_t j = 0; j < foci; ++j) {
      const double heard = magnitude(s_.pressure[j]);
      s_.turn[j] = s_.counts[j] && heard > 0 ? std::conj(s_.pressure[j]) / (heard * targets_[j]) : 0;
    }
    std::ranges::fill(s_.growth, 0);
    const std::size_t used = std::min<std::size_t>(effort_.transducers, columns_.transducers);
    const std::size_t stride = greedy_stride(static_cast<std::uint32_t>(columns_.transducers));
    const double each = static_cast<double>(columns_.transducers) / static_cast<double>(used);
    for (std::size_t i = 0, n = 0; i < used; ++i, n = (n + stride) % columns_.transducers) {
      const double x = does_[n].real(), y = does_[n].imag();
      for (std::size_t j = 0; j < foci; ++j) {
        const std::size_t entry = n * foci + j;
        const double re = columns_.loud[entry] * (x * columns_.cosine[entry] - y * columns_.sine[entry]);
        const double im = columns_.loud[entry] * (x * columns_.sine[entry] + y * columns_.cosine[entry]);
        s_.slopes[j] = -(s_.turn[j].real() * im + s_.turn[j].imag() * re);
      }
      const double by = each / stiffness_of(n);
      for (std::size_t j = 0; j < foci; ++j) {
        const double part = by * s_.slopes[j];
        for (std::size_t k = 0; k <= j; ++k)
          s_.growth[j * foci + k] += part * s_.slopes[k];
      }
    }
    for (std::size_t j = 0; j < foci; ++j) {
      for (std::size_t k = 0; k < j; ++k)
        s_.growth[k * foci + j] = s_.growth[j * foci + k];
    }
  }

  /// Fills the tried drives, their pressure and their loudness.
  void try_shares(double stiffness) {
    find_pull(s_.tried_shares, s_.pull);
    for (std::size_t n = 0; n < columns_.transducers; ++n) {
      const double x = does_[n].real(), y = does_[n].imag();
      const Complex pull = pulled(columns_, n, s_.pull);
      const double by = std::clamp(-(pull.real() * y + pull.imag() * x) / (stiffness * stiffness_of(n)),
                                   -climb_most_turn, climb_most_turn);
      const double cosine = std::cos(by), sine = std::sin(by);
      s_.tried[n] = {x * cosine - y * sine, x * sine + y * cosine};
    }
    listen(columns_, s_.tried, s_.tried_pressure);
    find_loudness(s_.tried_pressure, s_.tried_loud);
  }
  void keep() {
    std::ranges::copy(s_.tried, does_.begin());
    std::swap(s_.pressure, s_.tried_pressure);
    std::swap(s_.loud, s_.tried_loud);
  }

  /// The goal of a stage; `sharpness` 0: the weakest focus.
  double goal_of(std::span<const double> loud, double sharpness, double mean) const {
    const double least = weakest_of(loud, s_.counts);
    if (sharpness <= 0 || mean <= 0) return least;
    double sum = 0;
    for (std::size_t j = 0; j < loud.size(); ++j) {
      if (s_.counts[j]) sum += std::exp(-sharpness * (loud[j] - least) / mean);
    }
    return least - mean / sharpness * std::log(sum);
  }

  /// One stage of the climb.
  void rise(double sharpness, std::uint32_t steps) {
    double mean = 0, count = 0;
    for (std::size_t j = 0; j < s_.loud.size(); ++j) {
      mean += s_.loud[j];
      count += s_.counts[j];
    }
    mean /= count;
    const double spread = sharpness > 0 ? mean * count / sharpness : 0;
    double goal = goal_of(s_.loud, sharpness, mean);
    double stiffness = 1;
    bool fresh = true;
    for (std::uint32_t made = 0; made < steps && stiffness <= climb_most_stiffness; ++made) {
      if (fresh) find_growth();
      find_shares(s_.growth, s_.loud, s_.counts, stiffness, spread, s_.tried_shares, s_.step);
      try_shares(stiffness);
      const double then = goal_of(s_.tried_loud, sharpness, mean);
      fresh = then > goal;
      if (!fresh) {
        stiffness *= climb_stiffer;
        continue;
      }
      const bool ends = then - goal < mean * effort_.enough;
      goal = then;
      keep();
      std::ranges::copy(s_.tried_shares, shares_.begin());
      if (ends) return;
      stiffness = std::max(stiffness * climb_softer, climb_least_stiffness);
    }
  }

  void lower(double& weakest) {
    const double level = weakest;
    double uneven = unevenness(s_.loud, s_.counts, level);
    double aim = 1;
    bool fresh = true;
    for (std::uint32_t made = 0; made < effort_.lowerings && aim >= climb_least_aim; ++made) {
      double most = 0;
      for (std::size_t j = 0; j < s_.loud.size(); ++j) {
        s_.change[j] = s_.counts[j] ? aim * (level - s_.loud[j]) : 0;
        if (s_.counts[j]) most = std::max(most, s_.loud[j] - level);
      }
      if (most <= climb_even * level) return;
      if (fresh) find_growth();
      find_changes(s_.growth, s_.change, s_.counts, s_.tried_shares, s_.step);
      try_shares(1);
      const double then = weakest_of(s_.tried_loud, s_.counts);
      const double uneven_then = unevenness(s_.tried_loud, s_.counts, level);
      fresh = then >= climb_keep * level && uneven_then < uneven;
      if (!fresh) {
        aim /= climb_stiffer;
        continue;
      }
      uneven = uneven_then;
      weakest = then;
      keep();
      aim = std::min(1.0, 2 * aim);
    }
  }

  const Columns& columns_;
  const std::span<const double> targets_;
  const ClimbEffort& effort_;
  const std::span<double> shares_;
  const std::span<Complex> does_;
  ClimbScratch& s_;
  double soft_ = 0;
};

}  // namespace

void reserve(ClimbScratch& scratch, std::size_t transducers, std::size_t foci) {
  scratch.tried.reserve(transducers);
  for (std::vector<Complex>* values :
       {&scratch.pressure, &scratch.tried_pressure, &scratch.pull, &scratch.stiff_pull, &scratch.turn})
    values->reserve(foci);
  for (std::vector<double>* values : {&scratch.loud, &scratch.tried_loud, &scratch.tried_shares, &scratch.change,
                                      &scratch.slopes, &scratch.step.ones, &scratch.step.rest})
    values->reserve(foci);
  for (std::vector<double>* values : {&scratch.growth, &scratch.step.normal})
    values->reserve(foci * foci);
  for (std::vector<std::uint8_t>* values : {&scratch.counts, &scratch.step.takes, &scratch.step.returns})
    values->reserve(foci);
}

double climb(const Columns& columns, std::span<const double> targets, const ClimbEffort& effort,
             std::span<double> shares, std::span<Complex> does, ClimbScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(targets.size() == foci && shares.size() == foci && does.size() == columns.transducers);
  if (columns.transducers == 0) return 0;
  scratch.tried.resize(does.size());
  for (std::vector<Complex>* values :
       {&scratch.pressure, &scratch.tried_pressure, &scratch.pull, &scratch.stiff_pull, &scratch.turn})
    values->resize(foci);
  for (std::vector<double>* values :
       {&scratch.loud, &scratch.tried_loud, &scratch.tried_shares, &scratch.change, &scratch.slopes})
    values->resize(foci);
  scratch.growth.resize(foci * foci);
  scratch.counts.resize(foci);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.counts[j] = targets[j] > 0 ? 1 : 0;
  return Climb(columns, targets, effort, shares, does, scratch).run();
}

}  // namespace palpa::array
