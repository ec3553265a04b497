// Waits until something begins.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace palpa::test {

/// Waits until a condition is true, at most two minutes, and returns whether it is: on a slow and busy machine, four
/// loops on the GPU that start together under AddressSanitizer need over half a minute. Not for what must end: silence
/// and the end of a program have limits of their own. `rest`: pause between two looks.
inline bool begins(const std::function<bool()>& condition,
                   std::chrono::milliseconds rest = std::chrono::milliseconds(2)) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::sleep_for(rest);
  }
  return true;
}

}  // namespace palpa::test
