// The skin of tracked hands: each bone is a capsule with a radius at either end, and the surface of all capsules
// together is sampled.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensing/joints/tracked_hand.hpp"
#include "sensing/skin_point.hpp"

namespace palpa::sensing {

/// The convex hull of two balls. Metres, world.
struct Capsule {
  Vec3 a{0}, b{0};
  double radius_a_m = 0, radius_b_m = 0;
};

/// Appends the 19 bones of a hand's fingers, from metacarpal to tip.
void append_capsules(const TrackedHand& hand, const Transform& T_world_joints, std::vector<Capsule>& out);

/// The distance from the capsule's surface, metres; negative inside.
double distance_to(const Capsule& capsule, const Vec3& point);

/// The distance between neighbouring skin points, about.
inline constexpr double skin_pitch_m = 1e-3;
/// More than two hands have.
inline constexpr std::size_t most_hand_points = 1U << 17;

/// Replaces `out` by points on the surface of the union of `capsules` that lie in `box`, numbered from 0: evenly, about
/// skin_pitch_m apart. The same capsules and box give the same points. Returns false, with no points, if there are more
/// than most_hand_points.
bool sample_skin(std::span<const Capsule> capsules, const Box& box, std::vector<SkinPoint>& out);

}  // namespace palpa::sensing
