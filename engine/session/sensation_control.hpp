// What other threads say about a sensation that plays: where the hand is, and when it starts and pauses.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "base/math.hpp"
#include "sensation/played.hpp"

namespace palpa::session {

/// The place of a hand on which a sensation plays. One thread writes, others read.
class HandPlace {
 public:
  struct Seen {
    std::optional<Transform> T_array_hand{};  ///< empty: there is no hand
    double captured_s = 0;                    ///< on the run's clock
    std::uint64_t number = 0;                 ///< of the change
  };
  void see(const Transform& T_array_hand, double captured_s) { put(T_array_hand, captured_s); }
  void lose() { put({}, 0); }
  Seen now() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  void put(const std::optional<Transform>& T_array_hand, double captured_s) {
    const std::lock_guard lock(mutex_);
    if (T_array_hand || seen_.T_array_hand) seen_ = {T_array_hand, captured_s, seen_.number + 1};
  }

  mutable std::mutex mutex_;
  Seen seen_;
};

/// Eleven days.
inline constexpr double most_start_s = 1e6;

/// Starts, pauses and moves a run in its time, from any thread.
class SensationControl {
 public:
  /// From now on, or `in_s` later, with silence until then: from the time `from_s` of the sensation. Throws bad_usage
  /// for times that are not finite, or are longer than most_start_s.
  void play(double from_s, double in_s = 0);
  /// Silence; the time stands.
  void pause();
  /// Whether it plays on the hand, if the run has one; otherwise at its own place.
  void follow(bool follows);
  /// Whether it plays, and has neither ended nor been paused.
  bool plays() const { return now().plays; }
  /// Whether the run has begun, with its link open, and has not ended. Offline: false.
  bool runs() const { return runs_; }
  /// The newest points that have sounded, where they did in the array's frame; at most `most`, oldest first. Empty
  /// after each start.
  std::vector<sensation::Point> newest(std::size_t most) const;

  // For the run.
  struct State {
    bool plays = true, follows = true;
    double from_s = 0, in_s = 0;
    std::uint64_t number = 0;  ///< of the change of `plays`, `from_s` and `in_s`
  };
  State now() const;
  /// It ended by itself, unless it was started again after the change `number`.
  void ended(std::uint64_t number);
  void sounded(const sensation::Point& point);
  void set_runs(bool runs) { runs_ = runs; }

 private:
  mutable std::mutex mutex_;
  State now_;
  std::atomic<bool> runs_ = false;
  std::deque<sensation::Point> newest_;
};

}  // namespace palpa::session
