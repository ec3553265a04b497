// The driver's time: CLOCK_MONOTONIC, or a test's own time, which passes only during sleeps.
#pragma once

namespace palpa::driver {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual double now_s() const = 0;
  virtual void sleep_s(double seconds) = 0;
};

/// The machine's clock.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
  void sleep_s(double seconds) override;
};

}  // namespace palpa::driver
