#include "driver/cameras/match.hpp"

#include <cmath>

namespace palpa::driver::cameras {
namespace {

std::uint32_t nearest(std::span<const double> times_s, double time_s) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < times_s.size(); ++i) {
    if (std::abs(times_s[i] - time_s) < std::abs(times_s[best] - time_s)) best = i;
  }
  return best;
}

}  // namespace

bool match(std::span<const Waiting> cameras, double period_s, std::span<std::uint32_t> chosen) {
  for (const Waiting& camera : cameras) {
    if (camera.times_s.empty()) return false;
  }
  const std::span<const double> first = cameras.front().times_s;
  for (auto of_first = static_cast<std::uint32_t>(first.size()); of_first-- > 0;) {
    chosen[0] = of_first;
    bool all = true;
    for (std::size_t c = 1; c < cameras.size() && all; ++c) {
      chosen[c] = nearest(cameras[c].times_s, first[of_first]);
      all = std::abs(cameras[c].times_s[chosen[c]] - first[of_first]) <= period_s / 2 + stamp_jitter_s;
    }
    if (all) return true;
  }
  return false;
}

}  // namespace palpa::driver::cameras
