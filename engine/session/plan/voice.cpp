#include "session/plan/voice.hpp"

#include <algorithm>

#include "geometry/haptics.hpp"

namespace palpa::session {
namespace {

/// Sectors divide the circle evenly, so the angle between two of them is the way round the shorter side.
std::uint32_t sectors_apart(std::uint32_t a, std::uint32_t b, std::uint32_t count) {
  const std::uint32_t apart = a > b ? a - b : b - a;
  return std::min(apart, count - apart);
}

std::uint32_t nearest_filled(const touch::Placement& placement, std::uint32_t sector) {
  const auto count = static_cast<std::uint32_t>(placement.foci.size());
  std::uint32_t best = count;
  for (std::uint32_t other = 0; other < count; ++other) {
    if (!placement.has(other)) continue;
    if (best == count || sectors_apart(sector, other, count) < sectors_apart(sector, best, count)) best = other;
  }
  return best;
}

}  // namespace

void make_voice(const touch::Placement& placement, std::uint32_t id, std::uint32_t solid,
                const array::VoiceOptions& options, array::Voice& voice) {
  voice.id = id;
  voice.solid = solid;
  voice.dwell_s = options.dwell_s;
  voice.gain = options.gain;
  voice.pressure_pa = options.pressure_pa.value_or(0);
  voice.target_pa = 0;
  voice.reached_pa.reset();
  voice.modulation_hz = placement.still() ? options.modulation_hz : 0;
  voice.modulation = options.modulation;
  voice.foci.clear();
  const auto count = static_cast<std::uint32_t>(placement.foci.size());
  for (std::uint32_t sector = 0; sector < count; ++sector) {
    const std::uint32_t filled = nearest_filled(placement, sector);
    if (filled == count) break;
    if (filled == sector || !placement.together) voice.foci.emplace_back(placement.foci[filled].position);
  }
  const auto foci = static_cast<std::uint32_t>(voice.foci.size());
  array::fill_order(foci, placement.together ? 1 : options.stride.value_or(geometry::usual_stride(foci)), voice.order);
  voice.foci_per_slot = placement.together ? foci : 1;
}

}  // namespace palpa::session
