// A recording that the user controls: play, stop, step, and go to a frame, at any speed.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "session/links/sources.hpp"

namespace palpa::viewer {

/// Where in a recording the player is, and how it plays.
struct Playback {
  std::uint64_t frame = 0, frames = 0;  ///< the current frame, and how many there are
  double time_s = 0, length_s = 0;      ///< since its first frame
  bool playing = true;
  double speed = 1;
  bool loop = true;
};

/// The viewer's thread says what to do, and the capture thread does it. Frames that are shown again, or out of order,
/// still get ascending times and numbers, so to a session they are new.
class RecordingPlayer {
 public:
  /// nullopt if no recording is open.
  std::optional<Playback> now() const;
  /// Plays or stops as `wanted` says, from the current frame. The frame and times of `wanted` are ignored.
  void play(const Playback& wanted);
  void go_to(std::uint64_t frame);
  /// Stops, and goes on by `frames` frames.
  void step(int frames);

  /// The kind `recording`, controlled by this player, which must outlive the sources that it opens. Not with
  /// --every-frame, where frames come as fast as they are asked for.
  session::SourceKind source();

 private:
  friend class PlayerSource;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Playback> now_;
  std::optional<std::uint64_t> go_to_;  ///< the frame to be shown next
};

}  // namespace palpa::viewer
