#include "session/plan/solid_haptics.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"

namespace palpa::session {
namespace {

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

SolidHaptics resolve(const geometry::Haptics& asked, const touch::FingerOptions& touch,
                     const array::VoiceOptions& voice) {
  SolidHaptics haptics{asked.foci.value_or(touch.foci), voice, asked.foci || asked.stride || asked.dwell_s};
  haptics.voice.stride = asked.stride.value_or(voice.stride.value_or(geometry::default_stride(haptics.foci)));
  haptics.voice.dwell_s = asked.dwell_s.value_or(voice.dwell_s);
  haptics.voice.gain = asked.intensity.value_or(voice.gain);
  if (asked.pressure_pa) haptics.voice.pressure_pa = asked.pressure_pa;
  return haptics;
}

}  // namespace

std::vector<SolidHaptics> resolve_haptics(const std::string& scene, std::span<const geometry::Solid> solids,
                                          const touch::FingerOptions& touch, const array::VoiceOptions& voice) {
  if (voice.stride) {
    const std::string fault = geometry::stride_fault(touch.foci, *voice.stride);
    if (!fault.empty()) throw bad_usage(fault);
  }
  if (voice.pressure_pa && !(*voice.pressure_pa > 0 && *voice.pressure_pa <= array::most_pressure_pa)) {
    throw bad_usage(fmt::format("a pressure of {} Pa is out of range: give one above 0 and at most {} Pa",
                                *voice.pressure_pa, array::most_pressure_pa));
  }
  std::vector<SolidHaptics> resolved;
  resolved.reserve(solids.size());
  for (const geometry::Solid& solid : solids) {
    const SolidHaptics& haptics = resolved.emplace_back(resolve(solid.haptics, touch, voice));
    const std::string fault = geometry::stride_fault(haptics.foci, *haptics.voice.stride);
    if (!fault.empty()) throw bad_input(scene, fmt::format("node '{}': {}", solid.name, fault));
  }
  return resolved;
}

double slot_length(std::span<const SolidHaptics> solids, const array::VoiceOptions& voice) {
  if (solids.empty()) return voice.dwell_s;
  std::int64_t common = 0;
  double shortest = solids.front().voice.dwell_s;
  for (const SolidHaptics& solid : solids) {
    common = std::gcd(common, nanoseconds(solid.voice.dwell_s));
    shortest = std::min(shortest, solid.voice.dwell_s);
  }
  // If the shortest dwell divides all others, it is the slot, however short.
  if (common == nanoseconds(shortest) || common < nanoseconds(shortest_slot_s)) return shortest;
  return static_cast<double>(common) * 1e-9;
}

}  // namespace palpa::session
