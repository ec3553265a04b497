#include "array/course.hpp"

#include <algorithm>
#include <cmath>

#include "array/schedule.hpp"

namespace palpa::array {
namespace {

/// Mixes the bits of a lattice point's coordinates (the finalizer of MurmurHash3), 0..1.
double random_at(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t seed) {
  std::uint64_t bits = seed;
  for (const std::int64_t coordinate : {x, y, z}) {
    bits = (bits + static_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15U;
    bits = (bits ^ (bits >> 33U)) * 0xff51afd7ed558ccdU;
    bits = (bits ^ (bits >> 33U)) * 0xc4ceb9fe1a85ec53U;
    bits ^= bits >> 33U;
  }
  return static_cast<double>(bits >> 11U) * 0x1p-53;
}

double mix(double a, double b, double share) {
  return a + (b - a) * share;
}

}  // namespace

double noise_at(const Vec3& place, std::uint32_t seed) {
  constexpr double farthest = 1e9;
  std::int64_t corner[3] = {};
  double share[3] = {};
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::clamp(place[axis], -farthest, farthest), below = std::floor(at), t = at - below;
    corner[axis] = static_cast<std::int64_t>(below);
    share[axis] = t * t * t * (t * (6 * t - 15) + 10);
  }
  const std::int64_t x = corner[0], y = corner[1], z = corner[2];
  const auto along_x = [&](std::int64_t dy, std::int64_t dz) {
    return mix(random_at(x, y + dy, z + dz, seed), random_at(x + 1, y + dy, z + dz, seed), share[0]);
  };
  return mix(mix(along_x(0, 0), along_x(1, 0), share[1]), mix(along_x(0, 1), along_x(1, 1), share[1]), share[2]);
}

bool Course::changes() const {
  const bool vibrates = (from.motion > 0 || to.motion > 0) && texture.low + texture.high > 0;
  return vibrates || from.force != to.force || begin_slot > 0 || end_slot != endless || !gains.empty();
}

Course::Values Course::at(std::uint64_t slot) const {
  if (slots == 0) return to;
  const double share =
      slot <= first_slot ? 0 : std::min(1.0, static_cast<double>(slot - first_slot) / static_cast<double>(slots));
  return {mix(from.force, to.force, share), mix(from.motion, to.motion, share),
          from.place + (to.place - from.place) * share};
}

double modulate(const Course& course, std::uint64_t slot, double slot_s) {
  if (slot < course.begin_slot || slot >= course.end_slot) return 0;
  if (!course.gains.empty()) {
    const std::uint64_t number = slot - std::min(slot, course.first_slot);
    return course.gains[std::min<std::uint64_t>(number, course.gains.size() - 1)];
  }
  const Course::Values now = course.at(slot);
  const Texture& texture = course.texture;
  double force = texture.steady;
  if (now.motion > 0) {
    const double midpoint_s = (static_cast<double>(slot) + 0.5) * slot_s;
    const auto vibration = [&](double weight, double hz, std::uint32_t seed) {
      if (weight == 0) return 0.0;
      return weight * noise_at(now.place, seed) * modulation_gain(Modulation::amplitude_sine, hz, midpoint_s);
    };
    force += now.motion * (vibration(texture.low, low_hz, 1) + vibration(texture.high, high_hz, 2));
  }
  const double share = now.force * force / (texture.steady + texture.low + texture.high);
  return std::sqrt(std::clamp(share, 0.0, 1.0));
}

}  // namespace palpa::array
