#include "array/solvers/silent_phases.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "array/field/turns.hpp"
#include "array/solvers/even_out.hpp"
#include "array/solvers/hearing.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

constexpr double first_damping = 1e-6, least_damping = 1e-12, most_damping = 1e3;
constexpr std::uint32_t few_tries = 12;  // after these, a step that gains little is the last one
constexpr double fast = 1.0 / 16;        // of the cost: a step with the products of an earlier one is good enough
constexpr double raise_damping = 1e-3;
constexpr double raise_worth = 1.01;      // a raise must make the weakest focus louder by this
constexpr double raise_depth = 1e-3;      // and leave nulls as deep as this
constexpr std::size_t block = 64;         // transducers
constexpr std::size_t products_each = 4;  // of a pair of rows

/// Turns `from` by a step, or not at all without one, into `to`.
struct Step {
  std::span<const double> along, across;  ///< one per row; empty: no step
};

[[gnu::always_inline]] inline void turn_block(const PhasedSounds& from, const Step& step, std::size_t first,
                                              std::size_t count, PhasedSounds& to) {
  std::array<double, block> by{}, cosine{}, sine{};
  const std::size_t stride = from.waves.stride;
  for (std::size_t j = 0; j < step.along.size(); ++j) {
    const double along = step.along[j], across = step.across[j];
    const double* const re = &from.waves.re[j * stride + first];
    const double* const im = &from.waves.im[j * stride + first];
    for (std::size_t n = 0; n < count; ++n)
      by[n] += along * re[n] + across * im[n];
  }
  for (std::size_t n = 0; n < block; ++n)
    wave_of_turns(by[n] * (0.5 / std::numbers::pi), cosine[n], sine[n]);
  for (std::size_t j = 0; j <= from.waves.rows; ++j) {  // the last are the drives
    const bool drives = j == from.waves.rows;
    const double* const re = drives ? &from.re[first] : &from.waves.re[j * stride + first];
    const double* const im = drives ? &from.im[first] : &from.waves.im[j * stride + first];
    double* const new_re = drives ? &to.re[first] : &to.waves.re[j * stride + first];
    double* const new_im = drives ? &to.im[first] : &to.waves.im[j * stride + first];
    for (std::size_t n = 0; n < count; ++n) {
      const double x = re[n], y = im[n];
      new_re[n] = x * cosine[n] - y * sine[n];
      new_im[n] = x * sine[n] + y * cosine[n];
    }
  }
}

[[gnu::always_inline]] inline void sum_block(std::size_t first, std::size_t count, PhasedSounds& to) {
  for (std::size_t j = 0; j < to.waves.rows; ++j) {
    const double* const re = &to.waves.re[j * to.waves.stride + first];
    const double* const im = &to.waves.im[j * to.waves.stride + first];
    Four sum_re{}, sum_im{};
    for (std::size_t n = 0; n < count; n += 4) {
      sum_re += four(re + n);
      sum_im += four(im + n);
    }
    to.sounds[j] += Complex(total(sum_re), total(sum_im));
  }
}

[[gnu::always_inline]] inline void pass(const PhasedSounds& from, const Step& step, PhasedSounds& to) {
  std::ranges::fill(to.sounds, Complex(0));
  for (std::size_t first = 0; first < from.waves.stride; first += block) {
    const std::size_t count = std::min(block, from.waves.stride - first);
    if (!step.along.empty()) turn_block(from, step, first, count, to);
    sum_block(first, count, to);
  }
}
void make_pass(const PhasedSounds& from, const Step& step, PhasedSounds& to) {
  in_lanes([&](auto) PALPA_INLINED { pass(from, step, to); });
}

/// Fills four products for each pair of rows, k <= j: Re Re, Re Im, Im Re, Im Im.
[[gnu::always_inline]] inline void multiply_all(const SplitRows& waves, std::span<double> all) {
  std::ranges::fill(all, 0);
  for (std::size_t first = 0; first < waves.stride; first += block) {
    const std::size_t count = std::min(block, waves.stride - first);
    double* products = all.data();
    for (std::size_t j = 0; j < waves.rows; ++j) {
      const double* const re = &waves.re[j * waves.stride + first];
      const double* const im = &waves.im[j * waves.stride + first];
      for (std::size_t k = 0; k <= j; ++k, products += products_each) {
        const double* const other_re = &waves.re[k * waves.stride + first];
        const double* const other_im = &waves.im[k * waves.stride + first];
        Four rr{}, ri{}, ir{}, ii{};
        for (std::size_t n = 0; n < count; n += 4) {
          const Four a = four(re + n), b = four(im + n), c = four(other_re + n), d = four(other_im + n);
          rr += a * c;
          ri += a * d;
          ir += b * c;
          ii += b * d;
        }
        products[0] += total(rr);
        products[1] += total(ri);
        products[2] += total(ir);
        products[3] += total(ii);
      }
    }
  }
}
void multiply_rows(SilentScratch& scratch) {
  const std::size_t rows = scratch.now.waves.rows;
  scratch.products.resize(products_each * rows * (rows + 1) / 2);
  in_lanes([&](auto) PALPA_INLINED { multiply_all(scratch.now.waves, scratch.products); });
}

void fit(std::size_t rows, std::size_t transducers, PhasedSounds& sounds) {
  SplitRows& waves = sounds.waves;
  waves.rows = rows;
  waves.transducers = transducers;
  waves.stride = (transducers + 7) / 8 * 8;
  for (std::vector<double>* values : {&waves.re, &waves.im})
    values->resize(rows * waves.stride);
  for (std::vector<double>* values : {&sounds.re, &sounds.im})
    values->resize(waves.stride);
  sounds.sounds.resize(rows);
}

/// How far a drive is from the goal.
struct State {
  double level = 0, weakest = 0, miss = 0, depth = 0, cost = 0;
  bool reached() const { return miss <= silent_miss && depth <= silent_depth; }
};

State state_of(const SilentGoal& goal, const PhasedSounds& sounds) {
  const std::size_t foci = goal.targets.size();
  State state;
  double heard = 0, wanted = 0;
  for (std::size_t j = 0; j < foci; ++j) {
    if (!(goal.targets[j] > 0)) continue;
    heard += magnitude(sounds.sounds[j]);
    wanted += goal.targets[j];
  }
  state.weakest = weakest_of(goal.targets, [&](std::size_t j) { return magnitude(sounds.sounds[j]); });
  if (!(heard > 0)) return state;
  state.level = heard / wanted;
  for (std::size_t j = 0; j < foci; ++j) {
    if (!(goal.targets[j] > 0)) continue;
    const double miss = 1 - magnitude(sounds.sounds[j]) / (goal.targets[j] * state.level);
    state.miss = std::max(state.miss, std::abs(miss));
    state.cost += miss * miss;
  }
  for (std::size_t j = foci; j < sounds.sounds.size(); ++j) {
    const double rest = magnitude(sounds.sounds[j]) / state.level;
    state.depth = std::max(state.depth, rest);
    state.cost += rest * rest;
  }
  return state;
}

/// The sum of t.
double wanted_of(const SilentGoal& goal) {
  double wanted = 0;
  for (const double target : goal.targets)
    wanted += target;
  return wanted;
}

/// |p| / (t L) of a focus, 0 without a target.
double share_of(const SilentGoal& goal, const PhasedSounds& sounds, double level, std::size_t focus) {
  const double wanted = goal.targets[focus] * level;
  return wanted > 0 ? magnitude(sounds.sounds[focus]) / wanted : 0;
}

/// A row of J: along Re w + across Im w of one row of waves.
struct Slope {
  std::size_t row;
  double along, across;
};

Slope slope_of(const SilentGoal& goal, const PhasedSounds& sounds, double level, std::size_t equation) {
  const std::size_t foci = goal.targets.size();
  if (equation < foci) {
    const double size = magnitude(sounds.sounds[equation]), wanted = goal.targets[equation] * level;
    if (!(size > 0 && wanted > 0)) return {equation, 0, 0};
    const Complex turn = std::conj(sounds.sounds[equation]) / (size * wanted);
    return {equation, -turn.imag(), -turn.real()};
  }
  const std::size_t part = equation - foci, row = foci + part / 2;
  return part % 2 == 0 ? Slope{row, 0, -1 / level} : Slope{row, 1 / level, 0};
}

double miss_of(const SilentGoal& goal, const PhasedSounds& sounds, double level, double push, std::size_t equation) {
  const std::size_t foci = goal.targets.size();
  if (equation < foci) {
    const double wanted = goal.targets[equation] * level;
    return wanted > 0 ? 1 + push - magnitude(sounds.sounds[equation]) / wanted : 0;
  }
  const std::size_t part = equation - foci;
  const Complex& heard = sounds.sounds[foci + part / 2];
  return -(part % 2 == 0 ? heard.real() : heard.imag()) / level;
}

/// The sum over the transducers of the products of two rows of J.
double product_of(std::span<const double> products, const Slope& a, const Slope& b) {
  const bool swaps = a.row < b.row;
  const Slope& upper = swaps ? b : a;
  const Slope& lower = swaps ? a : b;
  const double* const p = &products[products_each * (upper.row * (upper.row + 1) / 2 + lower.row)];
  return upper.along * (lower.along * p[0] + lower.across * p[1]) +
         upper.across * (lower.along * p[2] + lower.across * p[3]);
}

/// Lets L follow the foci: J becomes J - s w^T J for them, with s_j = |p_j| / (t_j L) and w_k = t_k / sum t, because dL
/// is a part of what each changes by.
void free_level(const SilentGoal& goal, const State& state, SilentScratch& scratch) {
  const std::size_t foci = goal.targets.size(), equations = scratch.rest.size();
  const double wanted = wanted_of(goal);
  std::vector<double>& mean = scratch.mean;
  const auto follow = [&](std::size_t step, std::size_t across) {
    mean.assign(equations, 0);
    for (std::size_t j = 0; j < foci; ++j) {
      for (std::size_t b = 0; b < equations; ++b)
        mean[b] += goal.targets[j] / wanted * scratch.normal[j * step + b * across];
    }
    for (std::size_t j = 0; j < foci; ++j) {
      const double share = share_of(goal, scratch.now, state.level, j);
      for (std::size_t b = 0; b < equations; ++b)
        scratch.normal[j * step + b * across] -= share * mean[b];
    }
  };
  follow(equations, 1);
  follow(1, equations);
}

/// From y of the changed J to that of J.
void give_back(const SilentGoal& goal, const State& state, SilentScratch& scratch) {
  const std::size_t foci = goal.targets.size();
  double sum = 0;
  for (std::size_t j = 0; j < foci; ++j)
    sum += share_of(goal, scratch.now, state.level, j) * scratch.rest[j];
  const double wanted = wanted_of(goal);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.rest[j] -= goal.targets[j] / wanted * sum;
}

enum class Level { free, kept };

/// Makes the next step of `scratch.now` into `scratch.tried`.
State try_step(const SilentGoal& goal, const State& state, Level level, double push, double damping,
               SilentScratch& scratch) {
  const std::size_t foci = goal.targets.size(), equations = foci + 2 * goal.null_rows;
  scratch.rest.resize(equations);
  scratch.normal.resize(equations * equations);
  for (std::size_t a = 0; a < equations; ++a) {
    const Slope slope = slope_of(goal, scratch.now, state.level, a);
    scratch.rest[a] = miss_of(goal, scratch.now, state.level, push, a);
    for (std::size_t b = 0; b <= a; ++b) {
      scratch.normal[a * equations + b] = scratch.normal[b * equations + a] =
          product_of(scratch.products, slope, slope_of(goal, scratch.now, state.level, b));
    }
  }
  if (level == Level::free) free_level(goal, state, scratch);
  solve_damped(scratch.normal, damping, false, scratch.rest);
  if (level == Level::free) give_back(goal, state, scratch);
  scratch.along.assign(foci + goal.null_rows, 0);
  scratch.across.assign(foci + goal.null_rows, 0);
  for (std::size_t a = 0; a < equations; ++a) {
    const Slope slope = slope_of(goal, scratch.now, state.level, a);
    scratch.along[slope.row] += slope.along * scratch.rest[a];
    scratch.across[slope.row] += slope.across * scratch.rest[a];
  }
  make_pass(scratch.now, {scratch.along, scratch.across}, scratch.tried);
  return state_of(goal, scratch.tried);
}

/// Steps until the goal is reached, or no step helps. Returns how many were tried.
std::uint32_t settle(const SilentGoal& goal, Level level, std::uint32_t tries, State& state, SilentScratch& scratch) {
  double damping = first_damping;
  std::uint32_t made = 0;
  bool known = false, new_ones = false;  // products, and whether they are those of the present waves
  while (!state.reached() && made < tries && damping <= most_damping && state.level > 0) {
    if (!known) {
      multiply_rows(scratch);
      known = new_ones = true;
    }
    const State then = try_step(goal, state, level, 0, damping, scratch);
    ++made;
    if (then.level > 0 && then.cost < state.cost) {
      const bool stalls = made > few_tries && then.cost > 0.5 * state.cost && then.miss <= silent_miss;
      known = then.cost < fast * state.cost;
      new_ones = false;
      state = then;
      std::swap(scratch.now, scratch.tried);
      damping = std::max(damping * 0.05, least_damping);
      if (stalls) break;
    } else if (new_ones) {
      damping *= 8;
    } else {
      known = false;
    }
  }
  return made;
}

}  // namespace

void silent_phases(const SilentGoal& goal, std::span<Complex> drive, SilentScratch& scratch) {
  const std::size_t foci = goal.targets.size(), rows = foci + goal.null_rows;
  assert(drive.size() == goal.foci.transducers && goal.null_rows <= goal.nulls.rows);
  for (PhasedSounds* sounds : {&scratch.now, &scratch.tried})
    fit(rows, drive.size(), *sounds);
  PhasedSounds& now = scratch.now;
  const std::size_t stride = now.waves.stride;
  std::ranges::fill(now.re, 0);
  std::ranges::fill(now.im, 0);
  for (std::size_t n = 0; n < drive.size(); ++n) {
    now.re[n] = drive[n].real();
    now.im[n] = drive[n].imag();
  }
  for (std::size_t j = 0; j < rows; ++j) {
    const SplitRows& from = j < foci ? goal.foci : goal.nulls;
    const std::size_t begin = (j < foci ? j : j - foci) * from.stride;
    const double loud = j < foci ? 1 : goal.loudness[j - foci];
    for (std::size_t n = 0; n < stride; ++n) {
      const double re = loud * from.re[begin + n], im = loud * from.im[begin + n];
      now.waves.re[j * stride + n] = re * now.re[n] - im * now.im[n];
      now.waves.im[j * stride + n] = re * now.im[n] + im * now.re[n];
    }
  }
  make_pass(now, {}, now);
  State state = state_of(goal, now);
  const double before = state.level;
  const std::uint32_t tries = settle(goal, Level::free, silent_tries, state, scratch);
  const bool has_lost = tries > silent_few || state.level < silent_keeps * before;
  if (has_lost && foci > 1 && rows <= silent_raised_rows) {
    double push = silent_push;
    for (std::uint32_t raise = 0; raise < silent_raises && push > silent_push / 4; ++raise) {
      scratch.kept = scratch.now;
      multiply_rows(scratch);
      State then = try_step(goal, state, Level::kept, push, raise_damping, scratch);
      std::swap(scratch.now, scratch.tried);
      settle(goal, Level::kept, silent_settles, then, scratch);
      if (then.weakest > raise_worth * state.weakest && then.depth < std::max(raise_depth, state.depth)) {
        state = then;
      } else {
        std::swap(scratch.now, scratch.kept);
        push /= 3;
      }
    }
    settle(goal, Level::kept, silent_tries, state, scratch);
  }
  for (std::size_t n = 0; n < drive.size(); ++n)
    drive[n] = {scratch.now.re[n], scratch.now.im[n]};
}

}  // namespace palpa::array
