#include "viewer/study/gate.hpp"

#include <algorithm>
#include <utility>

namespace palpa::viewer {
namespace {

void copy(const array::Schedule& from, array::Schedule& to) {
  to.slot_s = from.slot_s;
  to.time_s = from.time_s;
  to.advance = from.advance;
  to.voice_count = from.voice_count;
  to.voices.assign(from.voices.begin(), from.voices.begin() + static_cast<std::ptrdiff_t>(from.voice_count));
}

}  // namespace

void Gate::forget() {
  const std::lock_guard lock(mutex_);
  touch_ = {};
  digest_ = {};
}

PlayedTouch Gate::take() {
  const std::lock_guard lock(mutex_);
  if (touch_.counts.drives > 0) touch_.drives_sha256 = digest_.hex();
  digest_ = {};
  return std::exchange(touch_, {});
}

GateCounts Gate::counts() const {
  const std::lock_guard lock(mutex_);
  return touch_.counts;
}

bool Gate::is_recent(Clock::rep when, Clock::time_point now) {
  return when != closed && now - Clock::time_point(Clock::duration(when)) <= std::chrono::milliseconds(100);
}

void Gate::note(std::uint64_t slot, std::span<const array::TransducerDrive> drive, Clock::time_point now) {
  static_assert(sizeof(array::TransducerDrive) == 2 * sizeof(float));
  const bool sounds = session::sounds(drive);
  if (sounds) last_sound_ = now.time_since_epoch().count();
  const std::lock_guard lock(mutex_);
  count_sound(sounds, now);
  GateCounts& counts = touch_.counts;
  ++counts.drives;
  counts.sounding += sounds ? 1 : 0;
  if (last_slot_ && slot > *last_slot_ + 1) counts.skipped += slot - *last_slot_ - 1;
  last_slot_ = slot;
  touch_.end = slot + 1;
  digest_.add({reinterpret_cast<const char*>(drive.data()), drive.size_bytes()});
}

void Gate::note_silence(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  count_sound(false, now);
  last_slot_.reset();
}

void Gate::note_arrivals(std::uint64_t drives, Clock::time_point now) {
  if (drives > 0) last_arrival_ = now.time_since_epoch().count();
  const std::lock_guard lock(mutex_);
  touch_.counts.arrived = touch_.counts.arrived.value_or(0) + drives;
}

/// With the mutex held.
void Gate::count_sound(bool sounds, Clock::time_point now) {
  if (counted_until_) sounded_for_ += now - *counted_until_;
  counted_until_ = sounds ? std::optional(now) : std::nullopt;
}

Gate::Clock::duration Gate::sounded_for() const {
  const std::lock_guard lock(mutex_);
  return sounded_for_ + (counted_until_ ? now() - *counted_until_ : Clock::duration(0));
}

void Gate::note(const PlayedFrame& frame) {
  const std::lock_guard lock(mutex_);
  touch_.frames.push_back(frame);
  touch_.end = std::max(touch_.end, frame.from);
}

/// An open link has silenced its device.
GateLink::GateLink(std::unique_ptr<session::Link> link, Gate& gate) : link_(std::move(link)), gate_(&gate) {
  gate_->played_ = gate_->unsure_ = gate_->out_of_reach_ = false;
}

GateLink::~GateLink() {
  gate_->note_silence(gate_->now());
}

/// If the link fails, nobody knows what the device got.
template <typename Work>
void GateLink::pass(Work work) {
  try {
    work();
  } catch (...) {
    failed_ = true;
    if (gate_->played_) gate_->unsure_ = true;
    throw;
  }
}

/// A board that plays by its own clock would play its last plan on.
void GateLink::shut(std::uint64_t slot) {
  gate_->unheard_since_ = Gate::closed;
  nothing_.slot_s = newest_.schedule.slot_s;
  nothing_.time_s = newest_.schedule.time_s;
  if (std::exchange(passing_, false)) gate_->note({.from = slot, .until = slot, .schedule = nothing_});
  pass([&] { link_->plan({.schedule = nothing_, .slots = {.from = slot, .until = slot}}); });
}

/// Takes the drives that have arrived since the last call. Returns whether nothing has, although the link counts. A
/// board that was unplugged takes no drives, but its link waits for it.
bool GateLink::see_arrivals(Gate::Clock::time_point now) {
  const std::optional<session::Carried> carried = link_->carried();
  gate_->link_counts_ = carried.has_value();
  if (!carried) return false;
  gate_->out_of_reach_ = carried->out_of_reach;
  const std::uint64_t all = carried->completed.drives + carried->starting, before = std::exchange(arrived_, all);
  gate_->note_arrivals(all - std::min(all, before), now);
  if (all != before && !failed_) gate_->unsure_ = false;
  return all == before;
}

void GateLink::plan(const session::PlayedPlan& plan) {
  newest_.from = plan.slots.from;
  newest_.until = plan.slots.until;
  copy(plan.schedule, newest_.schedule);
  gate_->newest_s_ = plan.schedule.time_s;
  if (!gate_->is_open()) {
    withheld_.plans += plan.schedule.voice_count > 0 ? 1 : 0;
    shut(plan.slots.from);
    return;
  }
  if (passing_) gate_->note(newest_);
  if (plan.schedule.voice_count > 0) gate_->played_ = true;
  pass([&] { link_->plan(plan); });
}

void GateLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool planned) {
  const Gate::Clock::time_point now = gate_->now();
  if (gate_->is_open(now)) {
    // What sounds from here on began with an earlier plan.
    if (!std::exchange(passing_, true))
      gate_->note({.from = slot, .until = newest_.until, .schedule = newest_.schedule});
    const bool after_silence = !gate_->sounding(now);
    gate_->note(slot, drive, now);
    if (session::sounds(drive)) gate_->played_ = true;
    pass([&] { planned ? link_->send_planned(slot, drive) : link_->send(slot, drive); });
    const bool none_arrived = see_arrivals(now);
    if (newest_.schedule.voice_count > 0)
      gate_->frames_.passed(newest_.schedule.time_s, session::sounds(drive), !none_arrived);
    if (!none_arrived) {
      gate_->unheard_since_ = Gate::closed;
    } else if (session::sounds(drive) && (after_silence || gate_->unheard_since_ == Gate::closed)) {
      gate_->unheard_since_ = now.time_since_epoch().count();
    }
    return;
  }
  if (passing_) shut(slot);
  withheld_.drives += session::sounds(drive) ? 1 : 0;
  silence_.assign(drive.size(), {});
  pass([&] { link_->send(slot, silence_); });
  see_arrivals(now);  // of drives that were on their way
  gate_->note_silence(now);
}

void GateLink::finish() {
  gate_->out_of_reach_ = false;
  pass([&] { link_->finish(); });
  if (!failed_) gate_->unsure_ = gate_->played_ = false;  // the last silence has arrived
}

/// Drives and plans that the gate withheld are not lost.
std::optional<session::Carried> GateLink::carried() const {
  std::optional<session::Carried> carried = link_->carried();
  if (!carried) return carried;
  const auto add = [&](session::Passed& passed) {
    passed.drives += withheld_.drives;
    passed.plans += withheld_.plans;
  };
  if (carried->guard) add(*carried->guard);
  add(carried->submitted);
  add(carried->completed);
  return carried;
}

std::vector<session::LinkKind> behind_gate(std::vector<session::LinkKind> kinds, Gate& gate) {
  for (session::LinkKind& kind : kinds) {
    kind.open = [open = std::move(kind.open), &gate](const std::string& argument, const session::LinkSetting& setting) {
      return std::make_unique<GateLink>(open(argument, setting), gate);
    };
  }
  return kinds;
}

}  // namespace palpa::viewer
