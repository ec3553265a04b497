// A clock that advances only while a board or a test waits, and lets the board's other end work meanwhile. So nothing
// depends on the machine's speed.
#pragma once

#include <poll.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "driver/clock.hpp"

namespace palpa::test {

class ServedClock final : public driver::Clock {
 public:
  explicit ServedClock(std::function<void()> serve) : serve_(std::move(serve)) {}

  double now_s() const override { return now_s_; }
  void sleep_s(double seconds) override {
    for (const double end_s = now_s_ + seconds; now_s_ < end_s;)
      step(end_s);
  }
  void wait_s(double at_most_s, pollfd watched) override {
    for (const double end_s = now_s_ + at_most_s; now_s_ < end_s && poll(&watched, 1, 0) == 0;)
      step(end_s);
  }
  double day_at_zero_s() const override { return 1.7e9 + 0.0123; }

  /// Lets time pass until it is true, at most a minute of it, and returns whether it is.
  bool passes_until(const std::function<bool()>& done) {
    for (const double end_s = now_s_ + 60; !done(); step(end_s)) {
      if (now_s_ >= end_s) return false;
    }
    return true;
  }

 private:
  void step(double end_s) {
    now_s_ = std::min(now_s_ + 0.5e-3, end_s);
    serve_();
  }

  std::function<void()> serve_;
  double now_s_ = 1000;
};

}  // namespace palpa::test
