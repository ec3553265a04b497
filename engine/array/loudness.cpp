#include "array/loudness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "array/drive.hpp"
#include "array/pressures/many_foci.hpp"
#include "array/pressures/solver_traits.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Steps of the search for the amplitude to share.
constexpr int most_looks = 10;
/// A smaller target, in 1/m, counts as zero (a few micropascals), so that divisions by targets stay finite.
constexpr double least_target = 1e-6;

float square_max(std::span<const float> re, std::span<const float> im) {
  float most = 0;
  for (std::size_t n = 0; n < re.size(); ++n) {
    const float square = re[n] * re[n] + im[n] * im[n];
    most = square > most ? square : most;
  }
  return most;
}

/// The share of its crest that a voice's foci have in a slot.
double part_of(const Voice& voice, const SlotFocus& focus) {
  return voice.gain > 0 ? std::clamp(static_cast<double>(focus.gain) / voice.gain, least_modulation, 1.0) : 0;
}

}  // namespace

Loudness::Loudness(const Layout& layout, const DriveOptions& options)
    : layout_(layout), options_(options), farthest_(layout) {
  transfer_of(layout, options_, free_field_);
  for (std::vector<float>* values : {&re_, &im_, &own_re_, &own_im_})
    values->resize(layout.transducers.size());
}

bool Loudness::asked(const Schedule& schedule) {
  return std::any_of(schedule.voices.begin(), schedule.voices.begin() + schedule.voice_count,
                     [](const Voice& voice) { return voice.pressure_pa.has_value(); });
}

std::span<const Complex> Loudness::factors(std::uint32_t slot) const {
  return std::span(factors_).subspan(slots_[slot].first, slots_[slot].count);
}

void Loudness::solve(Schedule& schedule, std::uint32_t slots) {
  slot_count_ = part_count_ = 0;
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
    demands_.push_back({0, schedule.voices[v].pressure_pa.has_value()});
  levels_.assign(demands_.size(), 1);
  factors_ = full_;
  double peak = 0;
  for (const Slot& slot : used())
    peak = std::max(peak, peak_of(slot, demands_));
  const bool hard = std::ranges::any_of(given_, [](double given) { return given < 1; });
  const bool all_ask = std::ranges::all_of(demands_, &Demand::asks);
  if (peak > 1 || hard || !all_ask) share();
  for (const Slot& slot : used()) {
    if (slot.parts > 1) calm(slot);
  }
  tell(schedule);
}

void Loudness::add_slot(const Schedule& schedule, std::uint32_t number) {
  if (slot_count_ == slots_.size()) slots_.emplace_back();
  Slot& slot = slots_[slot_count_++];
  foci_of_slot(schedule, number, slot_foci_);
  slot.first = foci_.size();
  slot.count = slot_foci_.size();
  slot.first_part = part_count_;
  foci_.insert(foci_.end(), slot_foci_.begin(), slot_foci_.end());
  targets_.resize(foci_.size(), 0);
  given_.resize(foci_.size(), 1);
  full_.resize(foci_.size(), 0);
  for (std::size_t first = 0, end = 0; first < slot.count; first = end) {
    end = part_end(slot_foci_, first);
    if (part_count_ == parts_.size()) parts_.emplace_back();
    Part& part = parts_[part_count_++];
    part.first = slot.first + first;
    part.count = end - first;
    add_part(schedule, part);
  }
  slot.parts = part_count_ - slot.first_part;
}

void Loudness::find_sources(std::size_t first, std::size_t count) {
  sources_.clear();
  for (const SlotFocus& focus : std::span(foci_).subspan(first, count)) {
    // A focus that cannot be driven still has a column, which no drive uses.
    const Vec3 place = drivable(focus) ? focus.position : Vec3(0);
    sources_.push_back({place, farthest_.distance_from(place), 1});
  }
}

void Loudness::add_part(const Schedule& schedule, Part& part) {
  find_sources(part.first, part.count);
  transfer().fill(sources_, options_.weighting, columns_);
  multiply(columns_, part.matrix);
  keep_asks(part);
  const std::span<const SlotFocus> foci = std::span(foci_).subspan(part.first, part.count);
  const std::span<double> targets = std::span(targets_).subspan(part.first, part.count);
  for (std::size_t j = 0; j < part.count; ++j) {
    const Voice& voice = schedule.voices[foci[j].voice];
    const double alone = part.matrix.alone(j);
    if (!drivable(foci[j]) || !(alone > 0)) continue;
    const double full = voice.pressure_pa ? *voice.pressure_pa / layout_.source_level_pa_m : alone;
    const double target = full * voice.gain * part_of(voice, foci[j]);
    if (target > least_target) targets[j] = target;
  }
  cap_unasked(part.matrix, foci, targets);
  now_.assign(part.count, 0);
  for (std::size_t j = 0; j < part.count; ++j) {
    if (!(targets[j] > 0)) continue;
    // A focus that needs far more than is available would dominate the results for all others.
    now_[j] = std::min(targets[j], part.matrix.alone(j));
    given_[part.first + j] = now_[j] / targets[j];
  }
  const std::span<Complex> full = std::span(full_).subspan(part.first, part.count);
  start_pressures(part.matrix, columns_, phases_of(options_.solver), now_, full, scratch_);
  // Foci without a request yield the amplitude that a focus needs to be heard against them: apply_levels adds it.
  own_.assign(full.begin(), full.end());
  for (std::size_t j = 0; j < part.count; ++j) {
    if (!foci[j].most_pa) full[j] = 0;
  }
  correct(part, full);
  for (std::size_t j = 0; j < part.count; ++j) {
    if (!foci[j].most_pa) full[j] = own_[j];
  }
}

/// Repeats until foci with a request have `now_`.
void Loudness::correct(const Part& part, std::span<Complex> factors) {
  release_unasked(std::span(foci_).subspan(part.first, part.count), now_);
  correct_pressures(part.matrix, now_, factors, scratch_);
}

void Loudness::keep_asks(const Part& part) {
  for (std::size_t j = 0; j < part.count; ++j) {
    const SlotFocus& focus = foci_[part.first + j];
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
  for (const Part& part : std::span(parts_).first(part_count_)) {
    now_.resize(part.count);
    for (std::size_t j = 0; j < part.count; ++j) {
      const double level = levels_[foci_[part.first + j].voice];
      now_[j] = targets_[part.first + j] * level;
      factors_[part.first + j] = full_[part.first + j] * (level / given_[part.first + j]);
    }
    correct(part, std::span(factors_).subspan(part.first, part.count));
  }
}

double Loudness::peak_of_all() {
  double peak = 0;
  for (const Slot& slot : used())
    peak = std::max(peak, peak_of(slot, {}));
  return peak;
}

/// The sum of the fingers' amplitudes bounds every amplitude, but their sounds seldom meet in phase. A bisection finds
/// how much more there is to share.
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
  // The rest is due to rounding, and to foci correcting each other.
  double peak = peak_of_all();
  if (peak > 1) peak = quieten_unasked();
  if (peak <= 1) return;
  for (double& level : levels_)
    level /= peak;
  for (Complex& factor : factors_)
    factor /= peak;
}

/// Fingers with a request must be heard against those without one, which takes additional amplitude. Those without a
/// request yield, by bisection. Returns the remaining peak.
double Loudness::quieten_unasked() {
  shared_.assign(levels_.begin(), levels_.end());
  const auto apply = [&](double part) {
    for (std::size_t v = 0; v < levels_.size(); ++v)
      levels_[v] = shared_[v] * (demands_[v].asks ? 1 : part);
    apply_levels();
    return peak_of_all();
  };
  double fits = 0, too_much = 1;
  for (int look = 0; look < most_looks; ++look) {
    const double part = (fits + too_much) / 2;
    (apply(part) <= 1 ? fits : too_much) = part;
  }
  return apply(fits);
}

/// Where fingers were solved separately, ensures that no focus is louder than requested and no transducer exceeds 1.
void Loudness::calm(const Slot& slot) {
  find_sources(slot.first, slot.count);
  const std::span<Complex> factors = std::span(factors_).subspan(slot.first, slot.count);
  heard_.resize(slot.count);
  keep_below(transfer(), layout_, std::span(foci_).subspan(slot.first, slot.count), sources_, options_.weighting,
             factors, columns_, heard_);
  const double peak = peak_of(slot, {});
  if (peak <= 1) return;
  for (Complex& factor : factors)
    factor /= peak;
}

void Loudness::hear(const Slot& slot) {
  const std::span<const Complex> factors = std::span(factors_).subspan(slot.first, slot.count);
  heard_.resize(slot.count);
  if (slot.parts == 1) return array::hear(parts_[slot.first_part].matrix, factors, heard_);
  find_sources(slot.first, slot.count);
  hear_all(transfer(), layout_, sources_, options_.weighting, factors, columns_, heard_);
}

/// The pressure of a slot's focus at its own place, in Pa, without the other foci.
double Loudness::own_pressure(const Slot& slot, std::size_t focus) const {
  std::size_t p = slot.first_part;
  while (slot.first + focus >= parts_[p].first + parts_[p].count)
    ++p;
  const double alone = parts_[p].matrix.alone(slot.first + focus - parts_[p].first);
  return layout_.source_level_pa_m * std::abs(factors_[slot.first + focus]) * alone;
}

void Loudness::tell(Schedule& schedule) {
  constexpr double unheard = std::numeric_limits<double>::infinity();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    Voice& voice = schedule.voices[v];
    voice.target_pa = voice.pressure_pa ? voice.asked_pa() * levels_[v] : unheard;
    voice.reached_pa = unheard;
  }
  for (const Slot& slot : used()) {
    hear(slot);
    for (std::size_t j = 0; j < slot.count; ++j) {
      Voice& voice = schedule.voices[foci_[slot.first + j].voice];
      const double part = part_of(voice, foci_[slot.first + j]);
      const bool sounds = part > 0 && drivable(foci_[slot.first + j]);
      const double pascals = sounds ? layout_.source_level_pa_m * std::abs(heard_[j]) / part : 0;
      voice.reached_pa = std::min(*voice.reached_pa, pascals);
      if (!voice.pressure_pa)
        voice.target_pa = std::min(voice.target_pa, own_pressure(slot, j) / std::max(part, least_modulation));
    }
  }
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    Voice& voice = schedule.voices[v];
    if (*voice.reached_pa == unheard) voice.reached_pa = 0;
    if (voice.target_pa == unheard) voice.target_pa = 0;
  }
}

}  // namespace palpa::array
