#include "array/requested_play.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "array/field/turns.hpp"
#include "base/lanes.hpp"

namespace palpa::array {
namespace {

/// The search ends with this share of the limit, or when a step of the factor is this small, or after so many looks.
constexpr double enough = 0.998, fine = 1e-4;
constexpr int most_looks = 24;
/// Rounding of floats, by which a focus may be above its limit.
constexpr double rounding = 1e-6;
/// More foci at once are limited by these.
constexpr std::size_t most_foci = most_solved_foci;

/// The share of its crest that a focus has in this slot.
double modulation_of(const SlotFocus& focus) {
  return focus.most_pa && *focus.most_pa > 0 ? focus.pressure_pa.value_or(*focus.most_pa) / *focus.most_pa : 0;
}

}  // namespace

RequestedPlay::RequestedPlay(const Layout& layout, const BoardPlay& boards, const DriveOptions& options)
    : layout_(layout), boards_(boards) {
  field_.set(layout, options.medium, options.directivity);
  for (std::vector<float>* values : {&exact_, &played_, &best_})
    values->resize(layout.transducers.size());
}

void RequestedPlay::round(std::span<TransducerDrive> drive, std::span<const SlotFocus> foci, double ceiling,
                          double scale) {
  looks_ = 0;
  find_foci(foci);
  if (asks_.empty()) return boards_.round(drive, ceiling);
  find_weights(drive);
  find_limits(drive, foci, scale);
  search(drive, ceiling);
  for (std::size_t t = 0; t < drive.size(); ++t)
    drive[t].amplitude = best_[t];
  for (std::size_t j = 0; j < asks_.size(); ++j) {
    const double exact_pa = limits_[j].exact_pa;
    parts_[j].played = exact_pa > 0 ? pressure_of(j, best_) / exact_pa : 1;
  }
}

void RequestedPlay::find_foci(std::span<const SlotFocus> foci) {
  asks_.clear();
  sources_.clear();
  parts_.clear();
  for (std::size_t i = 0; i < foci.size() && asks_.size() < most_foci; ++i) {
    if (!foci[i].most_pa || !(modulation_of(foci[i]) > 0) || !drivable(foci[i])) continue;
    asks_.push_back(i);
    sources_.push_back({foci[i].position, 1, 1});
    parts_.push_back({foci[i].voice});
  }
}

void RequestedPlay::find_weights(std::span<const TransducerDrive> drive) {
  field_.fill(sources_, Weighting::uniform, columns_);
  const std::size_t foci = asks_.size(), count = drive.size();
  for (std::vector<float>* values : {&re_, &im_})
    values->resize(foci * count);
  cosine_.resize(count);
  sine_.resize(count);
  for (std::size_t t = 0; t < count; ++t)
    cosine_[t] = static_cast<double>(drive[t].phase) / (2 * std::numbers::pi);
  in_lanes([&](auto) PALPA_INLINED {
    for (std::size_t t = 0; t < count; ++t)
      wave_of_turns(cosine_[t], cosine_[t], sine_[t]);
  });
  const double level = layout_.source_level_pa_m;
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t t = 0; t < count; ++t) {
      const std::size_t entry = t * foci + j;
      const double loud = level * columns_.loud[entry], c = columns_.cosine[entry], s = columns_.sine[entry];
      re_[j * count + t] = static_cast<float>(loud * (c * cosine_[t] - s * sine_[t]));
      im_[j * count + t] = static_cast<float>(loud * (c * sine_[t] + s * cosine_[t]));
    }
  }
}

void RequestedPlay::find_limits(std::span<const TransducerDrive> drive, std::span<const SlotFocus> foci, double scale) {
  for (std::size_t t = 0; t < drive.size(); ++t)
    exact_[t] = drive[t].amplitude;
  double strongest = 0;
  for (const std::size_t i : asks_)
    strongest = std::max(strongest, modulation_of(foci[i]));
  limits_.clear();
  for (std::size_t j = 0; j < asks_.size(); ++j) {
    const SlotFocus& focus = foci[asks_[j]];
    const double exact_pa = pressure_of(j, exact_);
    parts_[j].at_crest = modulation_of(focus) >= 0.5 * strongest;
    limits_.push_back({parts_[j].at_crest ? exact_pa : std::max(exact_pa, *focus.most_pa * scale), exact_pa});
  }
}

double RequestedPlay::pressure_of(std::size_t focus, std::span<const float> amplitudes) const {
  const std::size_t count = amplitudes.size();
  const float *const re = re_.data() + focus * count, *const im = im_.data() + focus * count;
  constexpr std::size_t lanes = 8;  // sums of their own, which are the same on every machine
  std::array<double, lanes> real{}, imaginary{};
  for (std::size_t t = 0; t < count; ++t) {
    real[t % lanes] += static_cast<double>(amplitudes[t] * re[t]);
    imaginary[t % lanes] += static_cast<double>(amplitudes[t] * im[t]);
  }
  std::complex<double> sum = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane)
    sum += std::complex(real[lane], imaginary[lane]);
  return std::abs(sum);
}

/// The largest pressure at a focus, relative to its limit.
double RequestedPlay::loudest_part(std::span<const float> amplitudes) const {
  double most = 0;
  for (std::size_t j = 0; j < asks_.size(); ++j) {
    if (limits_[j].pascals > 0) most = std::max(most, pressure_of(j, amplitudes) / limits_[j].pascals);
  }
  return most;
}

/// `fits` is below the limits, and `too_much` above them.
void RequestedPlay::search(std::span<const TransducerDrive> drive, double ceiling) {
  float loudest = 0, quietest = 1;
  for (const TransducerDrive& one : drive) {
    loudest = std::max(loudest, one.amplitude);
    if (one.amplitude > 0) quietest = std::min(quietest, one.amplitude);
  }
  std::ranges::fill(best_, 0.0f);
  if (!(loudest > 0)) return;
  // A step is nearest from half of it on. With the largest factor that is tried, all are at the ceiling, or as loud as
  // four times the drive or the first step.
  const double first = boards_.least() / static_cast<double>(loudest);
  double fits = 0.49 * first;
  double too_much = std::min(4 * std::max(1.0, first), std::max(1.01, 1.01 * ceiling / static_cast<double>(quietest)));
  if (fits >= too_much) return;  // nothing sounds
  double factor = std::clamp(1.0, fits * 1.001, too_much * 0.999), best = 0;
  double least_part = 0, most_part = 0;  // with these factors; the second is not known yet
  while (looks_ < most_looks && too_much - fits > fine * fits) {
    ++looks_;
    boards_.play(drive, static_cast<float>(factor), ceiling, played_);
    const double part = loudest_part(played_);
    if (part <= 1 + rounding) {
      fits = factor;
      least_part = part;
      if (part >= best) std::swap(best_, played_);
      best = std::max(best, part);
      if (part >= enough) return;
    } else {
      too_much = factor;
      most_part = part;
    }
    // Apart from steps, pressure follows the factor; every fourth look halves what is left.
    constexpr double target = (1 + enough) / 2;
    double next = part > 0 ? factor * target / part : 0;
    if (most_part > 0 && least_part > 0)
      next = fits + (too_much - fits) * (target - least_part) / (most_part - least_part);
    const bool helps = looks_ % 4 != 0 && next > fits && next < too_much;
    factor = helps ? next : (fits + too_much) / 2;
  }
}

}  // namespace palpa::array
