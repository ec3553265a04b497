// The driver's time: CLOCK_MONOTONIC, or a test's own time, which passes only during sleeps.
#pragma once

#include <poll.h>

namespace palpa::driver {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual double now_s() const = 0;
  virtual void sleep_s(double seconds) = 0;
  /// Sleeps at most so long: less if the descriptor is ready and the clock can see that.
  virtual void wait_s(double at_most_s, pollfd) { sleep_s(at_most_s); }
  /// The time of day, in seconds since 1970, when now_s() is 0.
  virtual double day_at_zero_s() const { return 0; }
};

/// The machine's clock.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
  void sleep_s(double seconds) override;
  void wait_s(double at_most_s, pollfd watched) override;
  double day_at_zero_s() const override;
};

/// A SteadyClock that lives as long as the program, for boards, which keep a reference.
Clock& steady_clock();

}  // namespace palpa::driver
