#include "viewer/sound/sounding.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::viewer {
namespace {

bool alike(const array::Voice& a, const array::Voice& b) {
  const auto near = [](const Vec3& p, const Vec3& q) { return glm::distance(p, q) <= alike_m; };
  return a.order == b.order && a.foci_per_slot == b.foci_per_slot && a.dwell_s == b.dwell_s && a.gain == b.gain &&
         a.modulation_hz == b.modulation_hz && a.modulation == b.modulation && a.pressure_pa == b.pressure_pa &&
         std::ranges::equal(a.foci, b.foci, near);
}

}  // namespace

bool alike(const array::Schedule& a, const array::Schedule& b) {
  if (a.voice_count != b.voice_count || a.slot_s != b.slot_s) return false;
  for (std::uint32_t v = 0; v < a.voice_count; ++v) {
    if (!alike(a.voices[v], b.voices[v])) return false;
  }
  return true;
}

std::optional<Vec3> tip_of(const touch::Touch& touch) {
  constexpr double fingertip = 12e-3;  // radius around its middle
  if (touch.finger_count == 0) return std::nullopt;
  Vec3 tip(touch.fingers[0].section.centroid);
  const Vec3 middle = tip;
  for (const std::vector<touch::Contact>* skin : {&touch.contacts, &touch.deep}) {
    for (const touch::Contact& point : *skin) {
      const Vec3 at(point.position);
      if (std::hypot(at.x - middle.x, at.z - middle.z) < fingertip) tip.y = std::min(tip.y, at.y);
    }
  }
  return tip;
}

}  // namespace palpa::viewer
