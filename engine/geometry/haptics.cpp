#include "geometry/haptics.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace palpa::geometry {

std::uint32_t default_stride(std::uint32_t foci) {
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

std::optional<Click> click_of(std::span<const double> numbers) {
  // 0.03 in single precision, as Blender may write it, is slightly less.
  const auto within = [](double x, double low, double high) { return x > low * (1 - 1e-6) && x < high * (1 + 1e-6); };
  if (numbers.size() != 2 || !within(numbers[0], 0.03, 0.06) || !within(numbers[1], 150, 200)) return std::nullopt;
  return Click{numbers[0], numbers[1]};
}

std::string row_fault(std::span<const DepthForce> before, const DepthForce& row) {
  const auto [depth_m, force] = row;
  if (!(depth_m >= 0 && depth_m <= 1))
    return fmt::format("has the depth {}; depths must be from 0 to 1 metres", depth_m);
  if (!before.empty() && !(depth_m > before.back().depth_m))
    return fmt::format("has the depth {} after {}; depths must ascend", depth_m, before.back().depth_m);
  if (!(force >= 0 && force <= 1)) return fmt::format("has the force {}; forces must be from 0 to 1", force);
  return {};
}

std::optional<std::array<double, 3>> texture_of(std::span<const double> numbers) {
  const bool fits = numbers.size() == 3 && std::ranges::all_of(numbers, [](double w) { return w >= 0 && w <= 1; }) &&
                    std::ranges::any_of(numbers, [](double w) { return w > 0; });
  return fits ? std::optional(std::array{numbers[0], numbers[1], numbers[2]}) : std::nullopt;
}

std::string stride_fault(std::uint32_t foci, std::uint32_t stride) {
  const std::uint32_t shared = std::gcd(foci, stride);
  if (foci == 1 || shared == 1) return {};
  return fmt::format(
      "stride {} and {} foci share the divisor {}, so some foci would never sound; give a stride such as {}", stride,
      foci, shared, default_stride(foci));
}

}  // namespace palpa::geometry
