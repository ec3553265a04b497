#include "observer/afferents/pressure_pattern.hpp"

#include <algorithm>
#include <cmath>

namespace palpa::observer {

double PressurePattern::period_s() const {
  if (slots.size() <= 1 && modulation_hz > 0) return 1 / modulation_hz;
  return slot_s * static_cast<double>(std::max<std::size_t>(slots.size(), 1));
}

std::vector<std::pair<std::uint32_t, double>> sounding(const PressurePattern& pattern, std::size_t n, double rate_hz) {
  std::vector<std::pair<std::uint32_t, double>> parts;
  if (pattern.slots.empty()) return parts;
  const double per_slot = 1 / (pattern.slot_s * rate_hz);
  const double from = static_cast<double>(n) * per_slot, until = static_cast<double>(n + 1) * per_slot;
  const double gain =
      array::modulation_gain(pattern.modulation, pattern.modulation_hz, (static_cast<double>(n) + 0.5) / rate_hz);
  // A slot that ends with the sample must not leave a rest because of rounding.
  constexpr double rounding = 1e-9;
  for (double slot = std::floor(from + rounding); slot < until - rounding; ++slot) {
    const double share = (std::min(until, slot + 1) - std::max(from, slot)) / (until - from);
    const auto at = static_cast<std::size_t>(slot) % pattern.slots.size();
    const std::uint32_t map = pattern.slots[at];
    if (parts.empty() || parts.back().first != map) parts.emplace_back(map, 0);
    parts.back().second += share * gain * gain;
  }
  return parts;
}

}  // namespace palpa::observer
