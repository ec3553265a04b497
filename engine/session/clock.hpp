// The loop's clock: seconds since its start. It never goes backwards.
#pragma once

#include <chrono>
#include <thread>

namespace palpa::session {

class Clock {
 public:
  double now() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  void sleep_until(double time_s) const {
    std::this_thread::sleep_until(begin_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                               std::chrono::duration<double>(time_s)));
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace palpa::session
