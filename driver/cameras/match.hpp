// Which frames of several cameras were captured together.
#pragma once

#include <cstdint>
#include <span>

namespace palpa::driver::cameras {

/// Frames of one camera that wait, oldest first; at least one: a camera that is not waited for is not asked about.
struct Waiting {
  std::span<const double> times_s;
};

/// Cameras run free: their frames of one rate stand in any phase to each other, so that of every camera some frame lies
/// within half a period of any of another's. This is how much more it may be, for the kernel's stamps are not exact.
constexpr double stamp_jitter_s = 0.5e-3;

/// `period_s` is that of the slowest. Chooses the newest frame of the first camera for which each of the others has one
/// within half a period, and of each the nearest. `chosen` gets one index per camera. False where there is no such set
/// yet.
bool match(std::span<const Waiting> cameras, double period_s, std::span<std::uint32_t> chosen);

}  // namespace palpa::driver::cameras
