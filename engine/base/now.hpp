// The steady clock as a number, to measure how long something takes.
#pragma once

#include <chrono>

namespace palpa {

/// Milliseconds since any moment.
inline double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace palpa
