// The driver's time: CLOCK_MONOTONIC, or a test's own, which passes only while somebody sleeps.
#pragma once

namespace palpa::driver {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual double now_s() const = 0;
  virtual void sleep_s(double seconds) = 0;
};

/// The machine's.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
  void sleep_s(double seconds) override;
};

}  // namespace palpa::driver
