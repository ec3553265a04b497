// A recording under somebody's hand: played, stopped, stepped through and gone to, at any speed.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "session/links/sources.hpp"

namespace palpa::viewer {

/// Where a recording is being played.
struct Playback {
  std::uint64_t frame = 0, frames = 0;  ///< of so many
  double time_s = 0, length_s = 0;      ///< since its first frame
  bool playing = true;
  double speed = 1;
  bool loop = true;
};

/// What the viewer's thread says and the capture thread does. Frames that are shown for a second time, or before those
/// that came before, have times and numbers that go on all the same: to a session they are new.
class RecordingPlayer {
 public:
  /// Nothing where no recording is open.
  std::optional<Playback> now() const;
  /// Plays on, or stops, as `wanted` says, from wherever it is: its frame and times are of no account.
  void play(const Playback& wanted);
  void go_to(std::uint64_t frame);
  /// Stops, and goes so many frames on.
  void step(int frames);

  /// The kind `recording`, under this hand. It outlives what it opens. Not with --every-frame, where frames come as
  /// fast as they are asked for.
  session::SourceKind source();

 private:
  friend class PlayerSource;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Playback> now_;
  std::optional<std::uint64_t> go_to_;  ///< a frame that is to be shown next
};

}  // namespace palpa::viewer
