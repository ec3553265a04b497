#include "array/solvers/climb.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "array/solvers/complex_system.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

/// Solves the system of the foci in `takes` in place, for both right-hand sides; the others get 0. `more` is added to
/// the diagonal.
void solve(std::span<const double> growth, std::span<const std::uint8_t> takes, double more, ShareScratch& scratch) {
  const std::size_t foci = takes.size();
  double trace = 0, count = 0;
  for (std::size_t j = 0; j < foci; ++j) {
    if (!takes[j]) continue;
    trace += growth[j * foci + j];
    count += 1;
  }
  const double ridge = std::max(share_ridge * trace / std::max(count, 1.0), 1e-30) + more;
  std::vector<double>& normal = scratch.normal;
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t k = 0; k < foci; ++k)
      normal[j * foci + k] = takes[j] && takes[k] ? growth[j * foci + k] : 0;
    normal[j * foci + j] = takes[j] ? normal[j * foci + j] + ridge : 1;
    if (!takes[j]) scratch.ones[j] = scratch.rest[j] = 0;
  }
  solve_positive(normal, {scratch.ones, scratch.rest});
}

void resize(ShareScratch& scratch, std::size_t foci) {
  scratch.normal.resize(foci * foci);
  for (std::vector<double>* values : {&scratch.ones, &scratch.rest})
    values->resize(foci);
  scratch.takes.resize(foci);
  scratch.returns.resize(foci);
}

/// Fills `shares`, of any sign and sum, so that every focus changes by `change`: K z = change.
void find_changes(std::span<const double> growth, std::span<const double> change, std::span<const std::uint8_t> counts,
                  std::span<double> shares, ShareScratch& scratch) {
  const std::size_t foci = change.size();
  resize(scratch, foci);
  std::ranges::fill(scratch.ones, 0);
  std::ranges::copy(change, scratch.rest.begin());
  solve(growth, counts, 0, scratch);
  std::ranges::copy(scratch.rest, shares.begin());
}

using Complex = std::complex<double>;

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
  Climb(const LaneColumns& columns, std::span<const double> targets, const ClimbEffort& effort,
        std::span<double> shares, LaneDrives& drive, ClimbScratch& scratch)
      : columns_(columns), targets_(targets), effort_(effort), shares_(shares), drive_(drive), s_(scratch) {}

  double run() {
    hear_lanes(columns_, drive_, s_.pressure);
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
    const std::size_t used = std::max<std::size_t>(effort_.transducers / lanes_together, 1);
    array::find_growth(columns_, drive_, s_.turn, {s_.stiff_pull, soft_},
                       std::max<std::size_t>(columns_.blocks / used, 1), s_.growth);
  }

  /// Fills the tried drives, their pressure and their loudness.
  void try_shares(double stiffness) {
    find_pull(s_.tried_shares, s_.pull);
    turn_lanes(columns_, drive_, s_.pull, {s_.stiff_pull, soft_}, stiffness, climb_most_turn, s_.tried,
               s_.tried_pressure);
    find_loudness(s_.tried_pressure, s_.tried_loud);
  }
  void keep() {
    std::swap(drive_, s_.tried);
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
      fresh = then >= effort_.keep * level && uneven_then < uneven;
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

  const LaneColumns& columns_;
  const std::span<const double> targets_;
  const ClimbEffort& effort_;
  const std::span<double> shares_;
  LaneDrives& drive_;
  ClimbScratch& s_;
  double soft_ = 0;
};

}  // namespace

double find_shares(std::span<const double> growth, std::span<const double> loud, std::span<const std::uint8_t> counts,
                   double stiffness, double spread, std::span<double> shares, ShareScratch& scratch) {
  const std::size_t foci = loud.size();
  resize(scratch, foci);
  std::ranges::copy(counts, scratch.takes.begin());
  double level = 0;
  for (std::uint32_t round = 0; round < share_rounds; ++round) {
    for (std::size_t j = 0; j < foci; ++j) {
      scratch.ones[j] = 1;
      scratch.rest[j] = loud[j];
    }
    solve(growth, scratch.takes, stiffness * spread, scratch);
    double ones = 0, rest = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      ones += scratch.ones[j];
      rest += scratch.rest[j];
    }
    level = ones > 0 ? (1 / stiffness + rest) / ones : 0;
    for (std::size_t j = 0; j < foci; ++j)
      shares[j] = stiffness * (level * scratch.ones[j] - scratch.rest[j]);
    bool changed = false;
    for (std::size_t j = 0; j < foci; ++j) {
      bool takes = shares[j] > 0;
      if (!scratch.takes[j]) {
        double grows = 0;
        for (std::size_t k = 0; k < foci; ++k)
          grows += growth[j * foci + k] * std::max(0.0, shares[k]);
        takes = counts[j] && loud[j] + grows / stiffness < level;
      }
      scratch.returns[j] = takes ? 1 : 0;
      changed = changed || takes != (scratch.takes[j] != 0);
    }
    if (!changed) break;
    std::ranges::copy(scratch.returns, scratch.takes.begin());
  }
  double sum = 0;
  for (double& share : shares) {
    share = std::max(0.0, share);
    sum += share;
  }
  for (double& share : shares)
    share = sum > 0 ? share / sum : 0;
  return level;
}

void reserve(ClimbScratch& scratch, std::size_t transducers, std::size_t foci) {
  scratch.tried.re.reserve(transducers + lanes_together);
  scratch.tried.im.reserve(transducers + lanes_together);
  for (std::vector<Complex>* values :
       {&scratch.pressure, &scratch.tried_pressure, &scratch.pull, &scratch.stiff_pull, &scratch.turn})
    values->reserve(foci);
  for (std::vector<double>* values : {&scratch.loud, &scratch.tried_loud, &scratch.tried_shares, &scratch.change,
                                      &scratch.step.ones, &scratch.step.rest})
    values->reserve(foci);
  for (std::vector<double>* values : {&scratch.growth, &scratch.step.normal})
    values->reserve(foci * foci);
  for (std::vector<std::uint8_t>* values : {&scratch.counts, &scratch.step.takes, &scratch.step.returns})
    values->reserve(foci);
}

double climb(const LaneColumns& columns, std::span<const double> targets, const ClimbEffort& effort,
             std::span<double> shares, LaneDrives& drive, ClimbScratch& scratch) {
  const std::size_t foci = columns.foci;
  assert(targets.size() == foci && shares.size() == foci);
  if (columns.transducers == 0) return 0;
  for (std::vector<Complex>* values :
       {&scratch.pressure, &scratch.tried_pressure, &scratch.pull, &scratch.stiff_pull, &scratch.turn})
    values->resize(foci);
  for (std::vector<double>* values : {&scratch.loud, &scratch.tried_loud, &scratch.tried_shares, &scratch.change})
    values->resize(foci);
  scratch.growth.resize(foci * foci);
  scratch.counts.resize(foci);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.counts[j] = targets[j] > 0 ? 1 : 0;
  return Climb(columns, targets, effort, shares, drive, scratch).run();
}

}  // namespace palpa::array
