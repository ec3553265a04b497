// Whether the array sounds now, as far as its link knows. The array itself is not asked.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

#include "session/links/hand_over.hpp"

namespace palpa::session {

/// Written by the thread that sends drives, read by any thread.
class SoundWatch {
 public:
  using Clock = std::chrono::steady_clock;
  /// A modulation has silent drives between those that sound. A pause of this length is silence.
  static constexpr std::chrono::milliseconds longest_lull{100};

  /// One more drive has left. `behind`: the link's counts; if it does not count, a drive arrives when it leaves.
  void sent(bool sounds, const std::optional<Carried>& behind, Clock::time_point now = Clock::now()) {
    const Clock::rep at = now.time_since_epoch().count();
    // What was lost at the end of an earlier sound is no longer waited for.
    if (sounds && (waits_since_ == never || !is_recent(left_, now))) waits_since_ = at;
    if (sounds) left_ = at;
    const std::uint64_t all = behind ? behind->completed.drives + behind->starting : 0;
    const bool arrives = behind ? all != arrived_ : sounds;
    arrived_ = all;
    out_of_reach_ = behind && behind->out_of_reach;
    if (!arrives) return;
    sounded_ = at;
    waits_since_ = never;
  }
  /// Nothing leaves any more.
  void close() {
    left_ = sounded_ = waits_since_ = never;
    out_of_reach_ = false;
  }

  /// Whether a drive that sounds has arrived within the longest lull.
  bool sounding(Clock::time_point now = Clock::now()) const { return is_recent(sounded_, now); }
  /// Whether drives that sound have left for longer than that, and none has arrived, or the link says that its device
  /// takes none, after it has sounded. It may then play its last sound on.
  bool stuck(Clock::time_point now = Clock::now()) const {
    const Clock::rep since = waits_since_;
    if (out_of_reach_ && sounded_ != never) return true;
    return since != never && !is_recent(since, now) && is_recent(left_, now);
  }

 private:
  static constexpr Clock::rep never = 0;
  static bool is_recent(Clock::rep at, Clock::time_point now) {
    return at != never && now - Clock::time_point(Clock::duration(at)) <= longest_lull;
  }

  std::atomic<Clock::rep> left_{never}, sounded_{never}, waits_since_{never};
  std::atomic<bool> out_of_reach_{false};
  std::uint64_t arrived_ = 0;
};

}  // namespace palpa::session
