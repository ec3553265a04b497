#include "session/links/safe_link.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "base/error.hpp"

namespace palpa::session {
namespace {

/// While a ramp moves, a plan is told anew that often: a board with a clock of its own has to load each of them.
constexpr double retell_s = 10e-3;

/// Runs `work`; the first error of all is kept, later ones are consequences.
template <typename Work>
void keep_error(std::exception_ptr& first, Work work) {
  try {
    work();
  } catch (...) {
    if (!first) first = std::current_exception();
  }
}

void scale(std::span<array::TransducerDrive> drives, double factor) {
  for (array::TransducerDrive& transducer : drives)
    transducer.amplitude *= static_cast<float>(factor);
}

}  // namespace

void check_safety(const Safety& safety) {
  if (!(safety.ceiling >= 0 && safety.ceiling <= 1))
    throw bad_usage(fmt::format("a link's ceiling is from 0 to 1, not {}", safety.ceiling));
  if (!(safety.ramp_s >= 0 && safety.ramp_s <= most_ramp_s))
    throw bad_usage(fmt::format("a link's ramp is from 0 to {} s, not {}", most_ramp_s, safety.ramp_s));
}

SafeLink::SafeLink(Link& link, std::size_t transducers, const Safety& safety, double slot_s)
    : link_(link), safety_(safety), transducers_(transducers), slot_s_(slot_s), silence_(transducers, {0.0f, 0.0f}) {
  check_safety(safety);
  nothing_.slot_s = slot_s;
  if (plain()) return;
  constexpr double rounding = 1e-9;  // 15 ms are ten slots of 1.5 ms, whatever doubles say
  if (ramped())
    ramp_drives_ = static_cast<std::uint32_t>(std::max(1.0, std::ceil(safety.ramp_s / slot_s * (1 - rounding))));
  reserve(kept_, transducers);
  reserve(scaled_, transducers);
  scaled_drive_.reserve(transducers);
  last_ = silence_;
}

SafeLink::~SafeLink() {
  try {
    finish();
  } catch (...) {  // what came before is the error to report
  }
}

void SafeLink::plan(const ToldPlan& told) {
  if (ended_) return;
  next_slot_ = std::max(next_slot_, told.from_slot);  // should the link fail, silence comes after what it was told
  nothing_.time_s = told.schedule.time_s;
  if (plain()) return pass_on(told);
  if (told.schedule.voice_count == 0) {
    on_ = false;
    if (!must_fade()) link_.plan(told);
    return;
  }
  kept_.schedule = told.schedule;
  kept_.cycle = told.cycle;
  kept_.drives.assign(told.drives.begin(), told.drives.end());
  kept_.shared_modulation_hz = told.shared_modulation_hz;
  kept_.shared_modulation = told.shared_modulation;
  until_slot_ = told.until_slot;
  on_ = true;
  tell_scaled(told.from_slot, ramped() ? factor(std::min(up_ + 1, ramp_drives_)) : safety_.ceiling);
}

HandOver SafeLink::handed_over() const {
  return {passed_, link_.carried()};
}

void SafeLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  if (ended_) return;
  if (plain()) {
    pass_on(slot, drive);
  } else if (!ramped()) {
    send_scaled(slot, drive, safety_.ceiling);
  } else {
    send_ramped(slot, drive);
  }
}

void SafeLink::silence() {
  plan({.schedule = nothing_, .from_slot = next_slot_, .until_slot = next_slot_});
  send(next_slot_, silence_);
}

void SafeLink::finish() {
  if (ended_) return;
  ended_ = true;
  std::exception_ptr fault;
  keep_error(fault, [&] { link_.plan({.schedule = nothing_, .from_slot = next_slot_, .until_slot = next_slot_}); });
  keep_error(fault, [&] { link_.send(next_slot_, silence_); });
  keep_error(fault, [&] { link_.finish(); });
  if (fault) std::rethrow_exception(fault);
}

void SafeLink::tell_scaled(std::uint64_t from_slot, double factor) {
  scaled_ = kept_;
  for (std::uint32_t v = 0; v < scaled_.schedule.voice_count; ++v) {
    array::Voice& voice = scaled_.schedule.voices[v];
    voice.gain *= factor;
    voice.target_pa *= factor;
    if (voice.reached_pa) *voice.reached_pa *= factor;
  }
  scale(scaled_.drives, factor);
  told_factor_ = factor;
  told_slot_ = from_slot;
  next_slot_ = std::max(next_slot_, from_slot);
  pass_on(told(scaled_, transducers_, from_slot, until_slot_));
}

void SafeLink::send_ramped(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  const bool audible = sounds(drive);
  on_ = on_ || audible;  // who tells no plans is heard, too
  const bool fading = !on_ && must_fade();
  if (on_ && up_ < ramp_drives_) ++up_;
  if (fading) --up_;
  // A modulation has all-zero drives of its own: what is to fade out is one that sounds.
  if (on_ && audible) last_.assign(drive.begin(), drive.end());
  if (fading && up_ == 0) {
    link_.plan({.schedule = nothing_, .from_slot = slot, .until_slot = slot});
  } else if (must_fade() && kept_.schedule.voice_count > 0 && factor(up_) != told_factor_) {
    if (fading) until_slot_ = slot + up_;
    const bool due = static_cast<double>(slot - told_slot_) * slot_s_ >= retell_s;
    if (due || up_ == ramp_drives_) tell_scaled(slot, factor(up_));
  }
  send_scaled(slot, fading ? std::span<const array::TransducerDrive>(last_) : drive, factor(up_));
}

void SafeLink::send_scaled(std::uint64_t slot, std::span<const array::TransducerDrive> drive, double factor) {
  scaled_drive_.assign(drive.begin(), drive.end());
  scale(scaled_drive_, factor);
  pass_on(slot, scaled_drive_);
}

void SafeLink::pass_on(const ToldPlan& told) {
  if (told.schedule.voice_count > 0) ++passed_.plans;
  link_.plan(told);
}

void SafeLink::pass_on(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  next_slot_ = slot;  // should the link fail, silence takes this drive's place
  if (sounds(drive)) ++passed_.drives;
  link_.send(slot, drive);
  next_slot_ = slot + 1;
}

}  // namespace palpa::session
