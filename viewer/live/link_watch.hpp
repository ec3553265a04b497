// What the array does at this moment. The array is not asked: this is what its link was given.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace palpa::viewer {

/// Written by the session's threads, read by the window's thread.
struct LinkWatch {
  using Clock = std::chrono::steady_clock;
  /// A modulation has silent drives between those that sound. A pause of this length is silence.
  static constexpr std::chrono::milliseconds longest_lull{100};

  std::atomic<bool> open{false};
  std::atomic<std::uint64_t> drives{0}, silent{0};

  /// One more drive has left.
  void count(bool sounds, Clock::time_point now = Clock::now()) {
    if (sounds) sounded_ = now.time_since_epoch().count();
    ++drives;
    silent += sounds ? 0 : 1;
  }
  /// Nothing leaves any more.
  void close() {
    open = false;
    sounded_ = never;
  }
  /// Whether a drive that left within the longest lull sounds.
  bool sounding(Clock::time_point now = Clock::now()) const {
    const Clock::rep last = sounded_;
    return last != never && now - Clock::time_point(Clock::duration(last)) <= longest_lull;
  }

 private:
  static constexpr Clock::rep never = 0;
  std::atomic<Clock::rep> sounded_{never};
};

}  // namespace palpa::viewer
