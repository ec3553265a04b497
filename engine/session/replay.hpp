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

#include "array/schedule.hpp"
#include "session/loop/output.hpp"
#include "session/player.hpp"
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
