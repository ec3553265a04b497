// A source that is played on its own clock: what palpa run would sound for it if every frame came without delay, as
// fast as frames are computed, the same on every machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "session/session.hpp"
#include "session/watch/pressure_log.hpp"

namespace palpa::session {

struct ReplayOptions {
  std::uint64_t frames = 0;  ///< stop after that many; 0: at the source's end
  /// After every frame, also without events, and at the end.
  std::function<void(std::span<const Event>)> events{};
  /// After every frame, before its events.
  std::function<void(const FrameReport&)> planned{};
};

struct ReplayStats {
  std::uint64_t frames = 0, touching = 0;
  std::uint64_t drives = 0, silent_drives = 0;  ///< slots whose drive was sent
  double slot_s = 0;
  double duration_s = 0;                ///< of all slots, on the source's clock
  std::vector<FingerPressure> fingers;  ///< where pressures were asked for
  std::vector<std::string> solids;      ///< the names of theirs
};
std::string to_json(const ReplayStats& stats);

/// A pause of days costs no more than this, nor one in slots of a microsecond.
inline constexpr double most_silence_s = 10;
inline constexpr std::uint64_t most_silent_slots = 10'000;

/// Slot s begins s slots after the first frame's capture. It plays the newest frame captured by then, and silence where
/// that is older than the session's hold; of a silence of more than most_silence_s, or most_silent_slots, only the
/// slots until then are sent. The end comes when the last frame's time to sound is over and a ramp is down; an all-zero
/// drive is the last that `link` gets, whatever happens. The link is told each frame's plan from the first slot that
/// begins after its capture, also where the next frame takes its place before that: Slots::from may then come twice. A
/// frame that is no newer than the one before is taken to be as old as that. Ends early when `stop` becomes true, also
/// by others. The session must be live(), its cameras the source's. Warns once of a pressure that is not reached.
/// Throws what touching or the link throws.
ReplayStats replay(Session& session, sensing::DepthSource& source, Link& link, const std::atomic<bool>& stop,
                   const ReplayOptions& options = {});

}  // namespace palpa::session
