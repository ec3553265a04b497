#include "session/plan/voice.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

#include "geometry/haptics.hpp"
#include "touch/fingers/nearest_filled.hpp"

namespace palpa::session {
void make_voice(const touch::Placement& placement, std::uint32_t id, std::uint32_t solid,
                const array::VoiceOptions& options, array::Voice& voice) {
  voice.id = id;
  voice.solid = solid;
  voice.dwell_s = options.dwell_s;
  voice.gain = options.gain;
  voice.pressure_pa = options.pressure_pa;
  voice.target_pa = 0;
  voice.reached_pa.reset();
  voice.modulation_hz = placement.still() ? options.modulation_hz : 0;
  voice.modulation = options.modulation;
  voice.course = {};
  voice.velocity = Vec3(0);
  voice.foci.clear();
  const auto count = static_cast<std::uint32_t>(placement.foci.size());
  for (std::uint32_t sector = 0; sector < count; ++sector) {
    const std::uint32_t filled =
        touch::nearest_filled(sector, count, [&](std::uint32_t i) { return placement.has(i); });
    if (filled == count) break;
    if (filled == sector || !placement.together) voice.foci.emplace_back(placement.foci[filled].position);
  }
  const auto foci = static_cast<std::uint32_t>(voice.foci.size());
  array::fill_order(foci, placement.together ? 1 : options.stride.value_or(geometry::default_stride(foci)),
                    voice.order);
  voice.foci_per_slot = placement.together ? foci : 1;
}

array::Schedule by_finger(const array::Schedule& plan, const touch::Touch& seen) {
  array::Schedule schedule = plan;
  schedule.voices.clear();
  schedule.clear();
  schedule.advance = plan.advance;
  const std::span voices = std::span(plan.voices).first(std::min<std::size_t>(plan.voice_count, plan.voices.size()));
  for (std::uint32_t f = 0; f < seen.finger_count; ++f) {
    array::Voice& voice = schedule.add_voice();
    const auto own = std::ranges::find(voices, seen.fingers[f].id, &array::Voice::id);
    if (own != voices.end()) voice = *own;
  }
  return schedule;
}

}  // namespace palpa::session
