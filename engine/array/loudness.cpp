#include "array/loudness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "array/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Looks for how much amplitude there is to share.
constexpr int most_looks = 10;
float square_max(std::span<const float> re, std::span<const float> im) {
  float most = 0;
  for (std::size_t n = 0; n < re.size(); ++n) {
    const float square = re[n] * re[n] + im[n] * im[n];
    most = square > most ? square : most;
  }
  return most;
}

/// What part of its crest a voice's foci have in a slot.
double part_of(const Voice& voice, const SlotFocus& focus) {
  return voice.gain > 0 ? std::clamp(static_cast<double>(focus.gain) / voice.gain, least_modulation, 1.0) : 0;
}

}  // namespace

Loudness::Loudness(const Layout& layout, const DriveOptions& options)
    : layout_(layout), options_(options), reach_(layout) {
  field_.set(layout, options.medium, options.directivity);
  for (std::vector<float>* values : {&re_, &im_, &own_re_, &own_im_})
    values->resize(layout.transducers.size());
}

bool Loudness::asked(const Schedule& schedule) {
  return std::any_of(schedule.voices.begin(), schedule.voices.begin() + schedule.voice_count,
                     [](const Voice& voice) { return voice.pressure_pa > 0; });
}

std::span<const Complex> Loudness::factors(std::uint32_t slot) const {
  return std::span(factors_).subspan(slots_[slot].first, slots_[slot].count);
}

void Loudness::solve(Schedule& schedule, std::uint32_t slots) {
  slot_count_ = 0;
  foci_.clear();
  targets_.clear();
  given_.clear();
  full_.clear();
  ask_of_.clear();
  std::size_t asks = 0;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    ask_of_.push_back(asks);
    asks += schedule.voices[v].foci.size();
  }
  if (asks > asks_.size()) asks_.resize(asks);
  for (Ask& ask : asks_)
    ask.known = false;
  for (std::uint32_t slot = 0; slot < slots; ++slot)
    add_slot(schedule, slot);

  demands_.clear();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v)
    demands_.push_back({0, schedule.voices[v].pressure_pa > 0});
  levels_.assign(demands_.size(), 1);
  factors_ = full_;
  double peak = 0;
  for (const Slot& slot : used())
    peak = std::max(peak, peak_of(slot, demands_));
  const bool hard = std::ranges::any_of(given_, [](double given) { return given < 1; });
  if (peak > 1 || hard) share();
  tell(schedule);
}

void Loudness::add_slot(const Schedule& schedule, std::uint32_t number) {
  if (slot_count_ == slots_.size()) slots_.emplace_back();
  Slot& slot = slots_[slot_count_++];
  foci_of_slot(schedule, number, slot_foci_);
  slot.first = foci_.size();
  slot.count = slot_foci_.size();
  foci_.insert(foci_.end(), slot_foci_.begin(), slot_foci_.end());
  sources_.clear();
  for (const SlotFocus& focus : slot_foci_) {
    // One that cannot be driven has a column all the same, which nobody asks anything of.
    const Vec3 place = drivable(focus) ? focus.position : Vec3(0);
    sources_.push_back({place, reach_.farthest(place), 1});
  }
  field_.fill(sources_, options_.weighting, columns_);
  slot.count <= most_solved_foci ? multiply(columns_, slot.matrix) : multiply_alone(columns_, slot.matrix);
  keep_asks(slot);
  targets_.resize(foci_.size(), 0);
  given_.resize(foci_.size(), 1);
  full_.resize(foci_.size(), 0);
  now_.assign(slot.count, 0);
  for (std::size_t j = 0; j < slot.count; ++j) {
    const SlotFocus& focus = slot_foci_[j];
    const Voice& voice = schedule.voices[focus.voice];
    const double alone = slot.matrix.alone(j), part = part_of(voice, focus);
    if (!drivable(focus) || !(alone > 0) || !(part > 0)) continue;
    const double full = voice.pressure_pa > 0 ? voice.pressure_pa / layout_.source_level_pa_m : alone;
    double& target = targets_[slot.first + j];
    target = full * voice.gain * part;
    // One that would need far more than there is would drown all that is said about the others.
    now_[j] = std::min(target, alone);
    given_[slot.first + j] = now_[j] / target;
  }
  solve_pressures(slot.matrix, columns_, phases_of(options_.solver), now_, std::span(full_).subspan(slot.first),
                  scratch_);
}

void Loudness::keep_asks(const Slot& slot) {
  for (std::size_t j = 0; j < slot.count; ++j) {
    const SlotFocus& focus = foci_[slot.first + j];
    Ask& ask = asks_[ask_of_[focus.voice] + focus.number];
    if (ask.known) continue;
    ask.known = true;
    ask.re.resize(columns_.transducers);
    ask.im.resize(columns_.transducers);
    for (std::size_t n = 0; n < columns_.transducers; ++n) {
      const Complex asked = columns_.ask(n * columns_.foci + j);
      ask.re[n] = static_cast<float>(asked.real());
      ask.im[n] = static_cast<float>(asked.imag());
    }
  }
}

double Loudness::peak_of(const Slot& slot, std::span<Demand> takes) {
  std::ranges::fill(re_, 0.0f);
  std::ranges::fill(im_, 0.0f);
  for (std::size_t j = slot.first; j < slot.first + slot.count;) {
    const std::uint32_t voice = foci_[j].voice;
    double given = 1;
    std::ranges::fill(own_re_, 0.0f);
    std::ranges::fill(own_im_, 0.0f);
    for (; j < slot.first + slot.count && foci_[j].voice == voice; ++j) {
      const Ask& ask = asks_[ask_of_[voice] + foci_[j].number];
      given = std::min(given, given_[j]);
      const auto re = static_cast<float>(factors_[j].real()), im = static_cast<float>(factors_[j].imag());
      for (std::size_t n = 0; n < own_re_.size(); ++n) {
        own_re_[n] += re * ask.re[n] - im * ask.im[n];
        own_im_[n] += re * ask.im[n] + im * ask.re[n];
      }
    }
    for (std::size_t n = 0; n < re_.size(); ++n) {
      re_[n] += own_re_[n];
      im_[n] += own_im_[n];
    }
    if (takes.empty()) continue;
    const double own = std::sqrt(static_cast<double>(square_max(own_re_, own_im_)));
    takes[voice].takes = std::max(takes[voice].takes, own / given);
  }
  return std::sqrt(static_cast<double>(square_max(re_, im_)));
}

void Loudness::apply_levels() {
  for (const Slot& slot : used()) {
    now_.resize(slot.count);
    for (std::size_t j = 0; j < slot.count; ++j) {
      const double level = levels_[foci_[slot.first + j].voice];
      now_[j] = targets_[slot.first + j] * level;
      factors_[slot.first + j] = full_[slot.first + j] * (level / given_[slot.first + j]);
    }
    correct_pressures(slot.matrix, now_, std::span(factors_).subspan(slot.first, slot.count), scratch_);
  }
}

double Loudness::peak_of_all() {
  double peak = 0;
  for (const Slot& slot : used())
    peak = std::max(peak, peak_of(slot, {}));
  return peak;
}

/// The sum of what fingers take bounds every amplitude, but their sounds seldom meet in phase: by halves, how much more
/// there is to share.
void Loudness::share() {
  double fits = 1, too_much = 0;
  for (const Demand& demand : demands_)
    too_much += std::min(demand.takes, 1.0);
  if (too_much > 1) {
    for (int look = 0; look < most_looks; ++look) {
      const double budget = look == 0 ? too_much : (fits + too_much) / 2;
      share_out(demands_, budget, levels_);
      apply_levels();
      const bool fitting = peak_of_all() <= 1;
      (fitting ? fits : too_much) = budget;
      if (fitting && look == 0) return;
    }
  }
  share_out(demands_, fits, levels_);
  apply_levels();
  // What is left over is rounding, and how foci correct each other.
  const double peak = peak_of_all();
  if (peak <= 1) return;
  for (double& level : levels_)
    level /= peak;
  for (Complex& factor : factors_)
    factor /= peak;
}

void Loudness::tell(Schedule& schedule) {
  constexpr double unheard = std::numeric_limits<double>::infinity();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    Voice& voice = schedule.voices[v];
    voice.target_pa = voice.pressure_pa * voice.gain * levels_[v];
    voice.reached_pa = unheard;
  }
  for (const Slot& slot : used()) {
    heard_.resize(slot.count);
    MatrixHearing(slot.matrix).hear(std::span<const Complex>(factors_).subspan(slot.first, slot.count), heard_);
    for (std::size_t j = 0; j < slot.count; ++j) {
      Voice& voice = schedule.voices[foci_[slot.first + j].voice];
      const double part = part_of(voice, foci_[slot.first + j]);
      const bool sounds = part > 0 && drivable(foci_[slot.first + j]);
      const double pascals = sounds ? layout_.source_level_pa_m * std::abs(heard_[j]) / part : 0;
      voice.reached_pa = std::min(*voice.reached_pa, pascals);
    }
  }
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    Voice& voice = schedule.voices[v];
    if (*voice.reached_pa == unheard) voice.reached_pa = 0;
    if (!(voice.pressure_pa > 0)) voice.target_pa = *voice.reached_pa;
  }
}

}  // namespace palpa::array
