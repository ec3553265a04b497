// What the array does at this moment. The array is not asked: this is what its link was given.
#pragma once

#include <atomic>
#include <cstdint>

namespace palpa::viewer {

/// Written by the session's threads, read by the window's thread.
struct LinkWatch {
  std::atomic<bool> open{false};
  std::atomic<bool> sounding{false};  ///< the last drive was not silence
  std::atomic<std::uint64_t> drives{0}, silent{0};

  /// One more drive has left.
  void count(bool sounds) {
    sounding = sounds;
    ++drives;
    silent += sounds ? 0 : 1;
  }
};

}  // namespace palpa::viewer
