// Plays plans slot by slot, as fast as drives are computed, without a clock. It is what a replay (session/replay.hpp)
// has instead of the output thread (session/loop/output.hpp).
#pragma once

#include <atomic>
#include <cstdint>

#include "array/schedule.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/output.hpp"
#include "session/plan/plan.hpp"

namespace palpa::session {

/// Limits the cost of a silence, even for a pause of days or slots of a microsecond.
inline constexpr double most_silence_s = 10;
inline constexpr std::uint64_t most_silent_slots = 10'000;

class Player {
 public:
  /// `link` and the setting's layout must outlive it. Throws as SafeLink does.
  Player(Link& link, const OutputSetting& setting);

  /// The time at which slot 0 begins, on the clock of the plans' captured_s. 0 until then.
  void begin_at(double time_s) { begin_s_ = time_s; }
  /// The slots before this one are not played. Call it before anything is played.
  void skip_to(std::uint64_t slot) { slot_ = slot; }

  /// The first slot that begins at that time or later, but no slot that was already played.
  std::uint64_t slot_at(double time_s) const;
  std::uint64_t next_slot() const { return slot_; }

  /// Announces to the link that the plan sounds from the next slot on.
  void tell(const Plan& plan);
  /// Sends the drives up to but not including slot `end`. The plan is silent `hold_s` after its frame's capture. If a
  /// silence is longer than most_silence_s or most_silent_slots, only the slots up to that limit are sent.
  void play_until(std::uint64_t end, const Plan& plan, const std::atomic<bool>& stop);
  /// Fades out the remaining sound, if there is a ramp.
  void fade(const Plan& plan, const std::atomic<bool>& stop);
  /// Sends silence. Nothing can be played after that.
  void finish() { safe_.finish(); }

  std::uint64_t drives() const { return drives_; }  ///< that were sent
  std::uint64_t silent_drives() const { return silent_drives_; }
  double duration_s() const { return static_cast<double>(slot_) * setting_.slot_s; }  ///< of all slots so far

 private:
  void tell_nothing(const Plan& plan);

  OutputSetting setting_;
  SafeLink safe_;
  SlotScratch scratch_;
  array::Schedule nothing_;
  double begin_s_ = 0;
  std::uint64_t slot_ = 0;
  std::uint64_t silent_slots_ = 0;  ///< consecutive silent slots so far
  std::uint64_t drives_ = 0, silent_drives_ = 0;
  bool sounding_ = false;
};

}  // namespace palpa::session
