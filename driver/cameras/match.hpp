// Which frames of several cameras were captured together.
#pragma once

#include <cstdint>
#include <span>

namespace palpa::driver::cameras {

/// The waiting frames of one camera, oldest first. There is at least one: a camera that is not waited for is left out.
struct Waiting {
  std::span<const double> times_s;
};

/// Cameras run free: frames of one rate have any phase to each other, so every camera has some frame within half a
/// period of any frame of another camera. This is the tolerance beyond that, because the kernel's stamps are not exact.
constexpr double stamp_jitter_s = 0.5e-3;

/// Chooses the newest frame of the first camera for which each other camera has a frame within half a period, and the
/// nearest frame of each. `period_s` is the period of the slowest camera. `chosen` gets one index per camera. Returns
/// false if there is no such set yet.
bool match(std::span<const Waiting> cameras, double period_s, std::span<std::uint32_t> chosen);

}  // namespace palpa::driver::cameras
