#include "session/overrides.hpp"

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

}  // namespace

std::uint32_t foci_on(const geometry::Solid& solid, const touch::Parameters& all) {
  return solid.haptics.foci.value_or(all.foci);
}

array::VoiceOptions voice_on(const geometry::Solid& solid, const array::VoiceOptions& all) {
  array::VoiceOptions own = all;
  own.stride = solid.haptics.stride.value_or(all.stride);
  own.dwell_s = solid.haptics.dwell_s.value_or(all.dwell_s);
  own.gain = solid.haptics.intensity.value_or(all.gain);
  return own;
}

bool has_own_schedule(const geometry::Solid& solid) {
  return solid.haptics.foci || solid.haptics.stride || solid.haptics.dwell_s;
}

double slot_length(std::span<const geometry::Solid> solids, const array::VoiceOptions& all) {
  if (solids.empty()) return all.dwell_s;
  std::int64_t common = 0;
  double shortest = voice_on(solids.front(), all).dwell_s;
  for (const geometry::Solid& solid : solids) {
    const double dwell_s = voice_on(solid, all).dwell_s;
    common = std::gcd(common, nanoseconds(dwell_s));
    shortest = std::min(shortest, dwell_s);
  }
  // A dwell that all share is the slot, however short.
  if (common == nanoseconds(shortest) || common < nanoseconds(shortest_slot_s)) return shortest;
  return static_cast<double>(common) * 1e-9;
}

void check_overrides(const std::string& file, std::span<const geometry::Solid> solids, const touch::Parameters& all,
                     const array::VoiceOptions& voice) {
  for (const geometry::Solid& solid : solids) {
    if (!solid.haptics.foci && !solid.haptics.stride) continue;
    const std::uint32_t foci = foci_on(solid, all), stride = voice_on(solid, voice).stride;
    const std::uint32_t shared = std::gcd(foci, stride);
    if (foci == 1 || shared == 1) continue;
    throw bad_input(file, fmt::format("node '{}': stride {} and {} foci share the divisor {}, so some foci would never "
                                      "sound; give its extras a stride such as {}",
                                      solid.name, stride, foci, shared, array::coprime_stride(foci, stride)));
  }
}

}  // namespace palpa::session
