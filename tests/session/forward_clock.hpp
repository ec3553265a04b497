// A clock that a test puts forward, so that it need not wait: it goes, or stands still in between.
#pragma once

#include <atomic>

#include "session/clock.hpp"

namespace palpa::test {

/// Waits take real time.
class ForwardClock : public session::Clock {
 public:
  explicit ForwardClock(bool goes = true) : goes_(goes) {}
  double now() const override { return (goes_ ? Clock::now() : 0) + ahead_s_; }
  /// Not from several threads at once.
  void forward(double seconds) { ahead_s_ = ahead_s_ + seconds; }
  double ahead_s() const { return ahead_s_; }

 private:
  bool goes_;
  std::atomic<double> ahead_s_{0};
};

}  // namespace palpa::test
