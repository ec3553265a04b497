// Plays a source on its own clock, as fast as frames are computed. The result is the sound of `palpa run` if every
// frame came without delay. It is the same on every machine. Schedules that were played can be played again.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/schedule.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/output.hpp"
#include "session/plan/plan.hpp"
#include "session/session.hpp"
#include "session/watch/pressure_log.hpp"
#include "session/watch/untouched.hpp"

namespace palpa::session {

/// Limits the cost of a silence, even for a pause of days or slots of a microsecond.
inline constexpr double most_silence_s = 10;
inline constexpr std::uint64_t most_silent_slots = 10'000;

/// Plays plans slot by slot, as fast as drives are computed, without a clock. It is what a replay has instead of the
/// output thread (session/loop/output.hpp).
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

struct ReplayOptions {
  std::uint64_t frames = 0;  ///< stop after this many; 0: at the source's end
  /// Called after every frame, even without events, and at the end.
  std::function<void(std::span<const Event>)> events{};
  /// Called after every frame, before its events.
  std::function<void(const FrameReport&)> planned{};
};

struct ReplayStats {
  std::uint64_t frames = 0, touching = 0;
  std::optional<UntouchedStats> untouched;      ///< if no frame had a finger; set by the caller
  std::uint64_t drives = 0, silent_drives = 0;  ///< slots whose drive was sent
  std::optional<sensing::Dropped> dropped;      ///< if something could be dropped
  double slot_s = 0;
  double duration_s = 0;                  ///< duration of all slots, on the source's clock
  std::vector<FingerPressure> fingers;    ///< filled if pressures were requested
  std::vector<std::string> solids;        ///< the names of their solids
  std::optional<array::DrivenBy> driven;  ///< how drives were computed
};
std::string to_json(const ReplayStats& stats);

/// Slot s begins s slots after the first frame's capture. It plays the newest frame captured by then, or silence if
/// that frame is older than the session's hold. If a silence is longer than most_silence_s or most_silent_slots, only
/// the slots up to that limit are sent. The replay ends when the last frame's hold is over and the ramp is down. The
/// last drive that `link` gets is all-zero, whatever happens. The link gets each frame's plan from the first slot that
/// begins after its capture, even if the next frame replaces it before that slot; Slots::from may then occur twice. A
/// frame that is not newer than the previous one gets the previous frame's time. Ends early when `stop` becomes true;
/// others may set it. The session must be live(), with the source's cameras. Warns once of a pressure that is not
/// reached. Throws the errors of touching and of the link.
ReplayStats replay(Session& session, sensing::DepthSource& source, Link& link, const std::atomic<bool>& stop,
                   const ReplayOptions& options = {});

/// Schedules that were played, with the first slot of each. The slots do not descend.
struct PlayedFoci {
  struct Frame {
    std::uint64_t slot = 0;
    array::Schedule schedule;
  };
  double slot_s = 0;
  std::vector<Frame> frames;
  std::vector<std::string> solids;  ///< names, by a voice's solid
};

/// Plays schedules again, on the host: each from its slot on until the slot of the next one, at most for the
/// setting's hold, and the last one for the hold. The first drive is that of the first schedule's slot; long silences
/// are cut as above. The last drive that `link` gets is all-zero, whatever happens. Ends early when `stop` becomes
/// true. Warns once of a pressure that is not reached. Throws the errors of the link.
ReplayStats replay(const PlayedFoci& played, const OutputSetting& setting, Link& link, const std::atomic<bool>& stop);

}  // namespace palpa::session
