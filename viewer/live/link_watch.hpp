// What a session's link was given, and whether it sounds.
#pragma once

#include <atomic>
#include <cstdint>

#include "session/watch/sound_watch.hpp"

namespace palpa::viewer {

/// Written by the session's threads, read by the window's thread.
struct LinkWatch {
  std::atomic<std::uint64_t> drives{0}, silent{0};
  session::SoundWatch sound;

  /// One more drive has left.
  void count(bool sounds, const session::HandOver& counts) {
    sound.sent(sounds, counts.behind);
    ++drives;
    silent += sounds ? 0 : 1;
  }
  /// Nothing leaves any more.
  void close() { sound.close(); }
};

}  // namespace palpa::viewer
