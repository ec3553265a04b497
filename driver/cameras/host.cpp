#include "driver/cameras/host.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "driver/clock.hpp"

namespace palpa::driver::cameras {

int Host::poll(std::span<pollfd> descriptors, double timeout_s) {
  const double end_s = now_s() + timeout_s;
  for (;;) {
    const double left_s = std::clamp(end_s - now_s(), 0.0, 60.0);
    const int result = ::poll(descriptors.data(), descriptors.size(), static_cast<int>(std::ceil(left_s * 1e3)));
    if (result >= 0) return result;
    if (errno != EINTR) return -errno;
  }
}

std::future<void> Host::beside(std::function<void()> work) {
  return std::async(std::launch::async, std::move(work));
}

double Host::now_s() {
  return SteadyClock().now_s();
}

}  // namespace palpa::driver::cameras
