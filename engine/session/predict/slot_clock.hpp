// Tells the thread that makes plans when their slots will sound.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "session/clock.hpp"
#include "session/predict/prediction.hpp"

namespace palpa::session {

/// The output thread says when slot 0 began. From then on, other threads know the time of every slot: no latency is
/// assumed. `clock` must outlive it.
class SlotClock {
 public:
  SlotClock(const Clock& clock, double slot_s) : clock_(clock), slot_s_(slot_s) {}

  void begin(double begin_s) { begin_s_ = begin_s; }

  /// The first slot that can play a plan that is being made now, of a frame captured at `captured_s` on the loop's
  /// clock. Nothing before begin().
  std::optional<FirstSlot> first(double captured_s) const {
    const double begin_s = begin_s_;
    if (std::isnan(begin_s)) return std::nullopt;
    const double next = std::floor(std::max(clock_.now() - begin_s, 0.0) / slot_s_) + 1;
    return FirstSlot{static_cast<std::uint64_t>(next), begin_s + (next + 0.5) * slot_s_ - captured_s};
  }

 private:
  const Clock& clock_;
  double slot_s_;
  std::atomic<double> begin_s_{std::numeric_limits<double>::quiet_NaN()};
};

}  // namespace palpa::session
