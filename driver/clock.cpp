#include "driver/clock.hpp"

#include <time.h>

#include <chrono>
#include <thread>

namespace palpa::driver {

double SteadyClock::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void SteadyClock::sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void SteadyClock::wait_s(double at_most_s, pollfd watched) {
  poll(&watched, 1, static_cast<int>(1e3 * at_most_s));
}

double SteadyClock::day_at_zero_s() const {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - now_s();
}

Clock& steady_clock() {
  static SteadyClock clock;
  return clock;
}

}  // namespace palpa::driver
