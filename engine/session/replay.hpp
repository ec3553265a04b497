// Plays a source on its own clock, as fast as frames are computed. The result is the sound of `palpa run` if every
// frame came without delay. It is the same on every machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "session/session.hpp"
#include "session/watch/pressure_log.hpp"

namespace palpa::session {

struct ReplayOptions {
  std::uint64_t frames = 0;  ///< stop after this many; 0: at the source's end
  /// Called after every frame, even without events, and at the end.
  std::function<void(std::span<const Event>)> events{};
  /// Called after every frame, before its events.
  std::function<void(const FrameReport&)> planned{};
};

struct ReplayStats {
  std::uint64_t frames = 0, touching = 0;
  std::uint64_t drives = 0, silent_drives = 0;  ///< slots whose drive was sent
  std::optional<sensing::Dropped> dropped;      ///< if something could be dropped
  double slot_s = 0;
  double duration_s = 0;                ///< duration of all slots, on the source's clock
  std::vector<FingerPressure> fingers;  ///< filled if pressures were requested
  std::vector<std::string> solids;      ///< the names of their solids
};
std::string to_json(const ReplayStats& stats);

/// Limits the cost of a silence, even for a pause of days or slots of a microsecond.
inline constexpr double most_silence_s = 10;
inline constexpr std::uint64_t most_silent_slots = 10'000;

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

}  // namespace palpa::session
