#include "session/links/safe_link.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "array/loudness.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "touch/types.hpp"

namespace palpa::session {
namespace {

/// Interval at which a plan is passed on again while a ramp moves. A board with its own clock has to load each of them.
constexpr double replan_s = 10e-3;
/// How much sound must have come before a warning that most of it is too faint.
constexpr double judged_s = 1;

/// Runs `work` and keeps only the first error; later ones are consequences.
template <typename Work>
void keep_error(std::exception_ptr& first, Work work) {
  try {
    work();
  } catch (...) {
    if (!first) first = std::current_exception();
  }
}

/// Multiplies the amplitude of every drive, or the gain and the pressures of every finger.
void scale(std::span<array::TransducerDrive> drives, double factor) {
  for (array::TransducerDrive& transducer : drives)
    transducer.amplitude *= static_cast<float>(factor);
}

void scale(array::Schedule& schedule, double factor) {
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    array::Voice& voice = schedule.voices[v];
    voice.gain *= factor;
    voice.target_pa *= factor;
    if (voice.reached_pa) *voice.reached_pa *= factor;
  }
}

}  // namespace

double ceiling_of(const Safety& safety) {
  const auto within = [](double now) { return now > 0 ? std::min(now, 1.0) : 0.0; };
  const double ceiling = safety.ceiling_now ? within(*safety.ceiling_now) : safety.ceiling;
  return safety.gain_now ? ceiling * within(*safety.gain_now) : ceiling;
}

void check_safety(const Safety& safety) {
  if (!(safety.ceiling >= 0 && safety.ceiling <= 1))
    throw bad_usage(fmt::format("a link's ceiling must be from 0 to 1, not {}", safety.ceiling));
  if (!(safety.ramp_s >= 0 && safety.ramp_s <= most_ramp_s))
    throw bad_usage(fmt::format("a link's ramp must be from 0 to {} s, not {}", most_ramp_s, safety.ramp_s));
}

SafeLink::SafeLink(Link& link, std::size_t transducers, const Safety& safety, double slot_s,
                   std::function<void(bool, const HandOver&)> sent, const array::DriveOptions& drive)
    : link_(link), safety_(safety), slot_s_(slot_s), sent_(std::move(sent)), silence_(transducers, {0.0f, 0.0f}) {
  check_safety(safety);
  nothing_.slot_s = slot_s;
  if (const array::Layout* const layout = link.boards(); layout && !layout->boards.empty()) {
    boards_.emplace(*layout);
    requested_.emplace(*layout, *boards_, drive);
    plays_plans_ = link.plays_plans();
  }
  if (plain()) return;
  constexpr double rounding = 1e-9;  // 15 ms are ten slots of 1.5 ms despite rounding
  if (ramped())
    ramp_drives_ = static_cast<std::uint32_t>(std::max(1.0, std::ceil(safety.ramp_s / slot_s * (1 - rounding))));
  for (Sound* sound : {&kept_, &scaled_}) {
    array::reserve(sound->schedule, touch::max_fingers, touch::max_foci);
    sound->drives.reserve(most_cycle * transducers);
    sound->foci.reserve(most_cycle);
  }
  scaled_drive_.reserve(transducers);
  last_ = silence_;
}

SafeLink::~SafeLink() {
  try {
    finish();
  } catch (...) {  // the earlier error is the one to report
  }
}

void SafeLink::plan(const PlayedPlan& plan) {
  if (ended_) return;
  next_slot_ = std::max(next_slot_, plan.slots.from);  // if the link fails, silence comes after this plan
  nothing_.time_s = plan.schedule.time_s;
  if (plain()) return pass_on(plan);
  if (plan.schedule.voice_count == 0) {
    on_ = false;
    if (!must_fade()) link_.plan(plan);
    return;
  }
  asks_ = array::Loudness::asked(plan.schedule);
  kept_.schedule = plan.schedule;
  kept_.schedule.advance = {};  // the drives that a link gets are of foci that stand
  kept_.cycle = plan.slots.cycle;
  kept_.foci.assign(plan.foci.begin(), plan.foci.end());
  if (boards_) find_loudest(plan);
  if (boards_ && !plays_plans_) {
    kept_.drives.clear();
    kept_.cycle.plays = Plays::slot_by_slot;
    kept_.cycle.length = 0;
  } else {
    kept_.drives.assign(plan.drives.begin(), plan.drives.end());
  }
  until_slot_ = plan.slots.until;
  on_ = true;
  pass_on_scaled(plan.slots.from, ramped() ? factor(std::min(up_ + 1, ramp_drives_)) : ceiling());
}

HandOver SafeLink::handed_over() const {
  return {passed_, link_.carried()};
}

void SafeLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned) {
  if (ended_) return;
  if (plain()) {
    pass_on(slot, drive, planned);
  } else if (!ramped()) {
    send_scaled(slot, drive, slot, ceiling(), planned);
  } else {
    send_ramped(slot, drive, planned);
  }
}

void SafeLink::silence() {
  plan({.schedule = nothing_, .slots = {next_slot_, next_slot_}});
  send(next_slot_, silence_);
}

void SafeLink::finish() {
  if (ended_) return;
  ended_ = true;
  std::exception_ptr fault;
  keep_error(fault, [&] { link_.plan({.schedule = nothing_, .slots = {next_slot_, next_slot_}}); });
  keep_error(fault, [&] { hand_over(next_slot_, silence_, false, false); });
  keep_error(fault, [&] { link_.finish(); });
  warn_if_mostly_silent();
  if (fault) std::rethrow_exception(fault);
}

void SafeLink::pass_on_scaled(std::uint64_t from_slot, double factor) {
  scaled_ = kept_;
  scale(scaled_.schedule, factor);
  scale(scaled_.drives, factor);
  if (boards_) round_plan(factor);
  passed_factor_ = factor;
  passed_slot_ = from_slot;
  next_slot_ = std::max(next_slot_, from_slot);
  pass_on({.schedule = scaled_.schedule,
           .slots = {from_slot, until_slot_, scaled_.cycle},
           .drives = scaled_.drives,
           .foci = scaled_.foci});
}

/// Rounds the drive of a slot of the last plan, which is multiplied by the factor.
void SafeLink::round(std::span<array::TransducerDrive> drive, std::uint64_t slot, double factor) {
  if (!asks_) return boards_->round(drive, ceiling());
  array::foci_of_slot(kept_.schedule, slot, foci_);
  requested_->round(drive, foci_, ceiling(), factor);
}

void SafeLink::round_plan(double factor) {
  const std::size_t transducers = silence_.size();
  for (std::size_t number = 0; number * transducers < scaled_.drives.size(); ++number)
    round(std::span(scaled_.drives).subspan(number * transducers, transducers), number, factor);
  if (!ramped() || up_ == ramp_drives_) warn_if_faint(factor);
}

/// Copies the loudest drive that the plan lists. If it lists none, the largest gain counts.
void SafeLink::find_loudest(const PlayedPlan& plan) {
  const std::size_t transducers = silence_.size();
  loudest_ = 0;
  loudest_drive_.clear();
  const bool rises = plan.schedule.once;  // a sensation may be faint now and loud later
  for (std::size_t entry = 0; entry < plan.drives.size() && !rises; ++entry) {
    if (!(plan.drives[entry].amplitude > loudest_)) continue;
    loudest_ = plan.drives[entry].amplitude;
    loudest_slot_ = entry / transducers;
  }
  if (plan.drives.empty() || rises) {
    for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v)
      loudest_ = std::max(loudest_, static_cast<float>(plan.schedule.voices[v].gain));
  } else if (loudest_ > 0) {
    const auto loudest = plan.drives.subspan(loudest_slot_ * transducers, transducers);
    loudest_drive_.assign(loudest.begin(), loudest.end());
  }
}

void SafeLink::warn_if_faint(double factor) {
  const float loudest = loudest_ * static_cast<float>(factor);
  bool faint = loudest > 0;
  if (faint && loudest_drive_.empty()) {
    faint = !boards_->sounds_at(loudest);
  } else if (faint) {
    scaled_drive_ = loudest_drive_;
    scale(scaled_drive_, factor);
    round(scaled_drive_, loudest_slot_, factor);
    faint = !sounds(scaled_drive_);
  }
  if (faint && !faint_ && !std::isfinite(boards_->least_to_say())) {
    log::warning("the array is silent: the files of its boards turn every transducer off");
  } else if (faint && !faint_) {
    log::warning(fmt::format(
        "the array is silent: the loudest amplitude is {:.3g}, and the least that {} boards play{} is {:g}; raise the "
        "ceiling, the gain or the pressure",
        loudest, boards_->finest()->title, boards_->has_factors() ? " with the factors of their files" : "",
        boards_->least_to_say()));
  }
  faint_ = faint;
}

/// Drives on a ramp do not count.
void SafeLink::count_rounded(bool asked, bool audible, double factor) {
  if (!asked || faint_ || (ramped() && factor != ceiling())) return;
  ++asked_;
  rounded_off_ += audible ? 0 : 1;
  if (static_cast<double>(asked_) * slot_s_ >= judged_s) warn_if_mostly_silent();
}

void SafeLink::warn_if_mostly_silent() {
  constexpr std::uint64_t few = 20;
  if (asked_ < few || 2 * rounded_off_ <= asked_ || std::exchange(told_mostly_silent_, true)) return;
  log::warning(fmt::format(
      "most of the sound is too faint: {} of {} drives have no amplitude of {:g}, the least that {} boards play{}, and "
      "are silent; raise the ceiling, the gain or the pressure",
      rounded_off_, asked_, boards_->least_to_say(), boards_->finest()->title,
      boards_->has_factors() ? " with the factors of their files" : ""));
}

void SafeLink::send_ramped(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned) {
  const bool audible = sounds(drive);
  on_ = on_ || audible;  // drives without a plan also sound
  const bool fading = !on_ && must_fade();
  if (on_ && up_ < ramp_drives_) ++up_;
  if (fading) --up_;
  // A modulation contains all-zero drives; the drive that fades out must be one that sounds.
  if (on_ && audible) {
    last_.assign(drive.begin(), drive.end());
    last_slot_ = slot;
  }
  if (fading && up_ == 0) {
    link_.plan({.schedule = nothing_, .slots = {slot, slot}});
  } else if (must_fade() && kept_.schedule.voice_count > 0 && factor(up_) != passed_factor_) {
    if (fading) until_slot_ = slot + up_;
    const bool due = static_cast<double>(slot - passed_slot_) * slot_s_ >= replan_s;
    if (due || up_ == ramp_drives_) pass_on_scaled(slot, factor(up_));
  }
  const auto now = fading ? std::span<const array::TransducerDrive>(last_) : drive;
  send_scaled(slot, now, fading ? last_slot_ : slot, factor(up_), planned);
}

/// `made_for` is the slot whose drive it is.
void SafeLink::send_scaled(std::uint64_t slot, std::span<const array::TransducerDrive> drive, std::uint64_t made_for,
                           double factor, bool planned) {
  const bool sounding = planned && factor > 0;  // a ceiling of 0 is silence, whatever the plan has
  // If a board plays the plan that was passed on, it modulates a single drive by itself. Foci that request a pressure
  // do not advance, so that the drive of a slot is the plan's.
  const std::uint32_t length = plays_plans_ && kept_.drives.size() == scaled_.drives.size() ? kept_.cycle.length : 0;
  const bool as_planned = asks_ && kept_.cycle.modulation_hz == 0 && factor == passed_factor_;
  if (sounding && (length == 1 || (length > 1 && as_planned))) {
    const std::size_t first = slot % length * silence_.size();
    const auto own = std::span<const array::TransducerDrive>(scaled_.drives).subspan(first, silence_.size());
    const bool asked = sounds(drive);
    count_rounded(asked, sounds(own), factor);
    return pass_on(slot, asked ? own : silence_, true);
  }
  scaled_drive_.assign(drive.begin(), drive.end());
  scale(scaled_drive_, factor);
  if (boards_) {
    const bool asked = factor > 0 && sounds(drive);
    round(scaled_drive_, made_for, factor);
    count_rounded(asked, sounds(scaled_drive_), factor);
  }
  pass_on(slot, scaled_drive_, sounding);
}

void SafeLink::pass_on(const PlayedPlan& plan) {
  if (plan.schedule.voice_count > 0) ++passed_.plans;
  link_.plan(plan);
}

void SafeLink::pass_on(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned) {
  next_slot_ = slot;  // if the link fails, silence takes this drive's place
  const bool audible = sounds(drive);
  if (audible) ++passed_.drives;
  hand_over(slot, drive, audible, planned);
}

void SafeLink::hand_over(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool audible,
                         bool planned) {
  planned ? link_.send_planned(slot, drive) : link_.send(slot, drive);
  next_slot_ = slot + 1;  // the slot is taken, even if the observer throws
  sounded_ = audible;
  if (sent_) sent_(audible, handed_over());
}

}  // namespace palpa::session
