#include "session/player.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpa::session {

Player::Player(Link& link, const OutputSetting& setting)
    : setting_(setting),
      safe_(link, setting.layout.transducers.size(), setting.safety, setting.slot_s, {}, setting.drive) {
  scratch_.reserve(setting);
  nothing_.slot_s = setting.slot_s;
}

std::uint64_t Player::slot_at(double time_s) const {
  // The tolerance ensures that rounding of summed times does not miss a slot.
  const double slots = std::ceil((time_s - begin_s_) / setting_.slot_s - 1e-6);
  return std::max(slot_, static_cast<std::uint64_t>(std::max(slots, 0.0)));
}

void Player::tell(const Plan& plan) {
  sounding_ = plan.schedule.voice_count > 0;
  if (sounding_) {
    const std::uint64_t until = slot_at(plan.captured_s + setting_.hold_s);
    safe_.plan(played(plan, setting_.layout.transducers.size(), slot_, until));
  } else {
    tell_nothing(plan);
  }
}

void Player::play_until(std::uint64_t end, const Plan& plan, const std::atomic<bool>& stop) {
  const std::uint64_t expiry = slot_at(plan.captured_s + setting_.hold_s);
  for (; slot_ < end && !stop; ++slot_) {
    const bool silent = plan.schedule.voice_count == 0 || slot_ >= expiry;
    if (silent && (silent_slots_ >= most_silent_slots ||
                   static_cast<double>(silent_slots_) * setting_.slot_s >= most_silence_s)) {
      slot_ = end;
      break;
    }
    if (silent && sounding_) tell_nothing(plan);
    sounding_ = !silent;
    // The slot number identifies the drive; the time decides only whether the plan has expired.
    const double now_s = silent ? plan.captured_s + setting_.hold_s : plan.captured_s;
    const auto drive = drive_of_slot(plan, slot_, now_s, setting_, scratch_);
    silent ? safe_.send(slot_, drive) : safe_.send_planned(slot_, drive);
    ++drives_;
    silent_drives_ += safe_.sounded() ? 0 : 1;
    silent_slots_ = silent && !safe_.must_fade() ? silent_slots_ + 1 : 0;
  }
}

void Player::fade(const Plan& plan, const std::atomic<bool>& stop) {
  if (safe_.must_fade() && std::exchange(sounding_, false)) tell_nothing(plan);
  while (safe_.must_fade() && !stop)
    play_until(slot_ + 1, plan, stop);
}

void Player::tell_nothing(const Plan& plan) {
  nothing_.time_s = plan.schedule.time_s;
  safe_.plan({.schedule = nothing_, .slots = {slot_, slot_}});
}

}  // namespace palpa::session
