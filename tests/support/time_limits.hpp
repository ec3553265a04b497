// Limits of processor time in tests. They find faults of another order of magnitude, such as work that grows with the
// square of a file's length, on slow machines, too. Benchmarks measure how long something takes.
#pragma once

#include <ctime>

namespace palpa::test {

/// Processor time of this process so far, all threads together. Other programs do not add to it.
inline double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A slow machine needs up to this many times as long as a quick one.
inline constexpr double slowest = 4;

}  // namespace palpa::test
