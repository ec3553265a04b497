// The steady clock as a number.
#pragma once

#include <chrono>
#include <ctime>

namespace palpa {

/// Milliseconds since any moment, to measure how long something takes.
inline double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds on CLOCK_MONOTONIC, which all processes of the machine share.
inline double monotonic_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace palpa
