#include "geometry/haptics.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <numeric>

namespace palpa::geometry {

std::uint32_t usual_stride(std::uint32_t foci) {
  std::uint32_t best = 1;
  const auto off = [foci](std::uint32_t stride) {  // tenths of a focus from the ideal stride
    return std::abs(10 * std::int64_t{stride} - 3 * std::int64_t{foci});
  };
  for (std::uint32_t stride = 2; stride < foci; ++stride) {
    if (std::gcd(stride, foci) == 1 && off(stride) <= off(best)) best = stride;
  }
  return best;
}

double force_at(std::span<const DepthForce> table, double depth_m) {
  if (table.empty()) return 1;
  if (depth_m <= table.front().depth_m) return table.front().force;
  for (std::size_t row = 1; row < table.size(); ++row) {
    const DepthForce &above = table[row - 1], &below = table[row];
    if (depth_m > below.depth_m) continue;
    return std::lerp(above.force, below.force, (depth_m - above.depth_m) / (below.depth_m - above.depth_m));
  }
  return table.back().force;
}

std::string stride_fault(std::uint32_t foci, std::uint32_t stride) {
  const std::uint32_t shared = std::gcd(foci, stride);
  if (foci == 1 || shared == 1) return {};
  return fmt::format(
      "stride {} and {} foci share the divisor {}, so some foci would never sound; give a stride such as {}", stride,
      foci, shared, usual_stride(foci));
}

}  // namespace palpa::geometry
