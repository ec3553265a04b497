// The hand's skeleton under flesh: tapered capsules, posed.
#pragma once

#include <array>
#include <vector>

#include "assets/generators/hand.hpp"

namespace palpa::assets {

/// The convex hull of two balls: a tapered capsule.
struct Bone {
  Vec3 a, b;
  double radius_a, radius_b;
};

/// Distance to the capsule's surface, negative inside.
double distance(const Bone& bone, const Vec3& point);

/// A finger beyond its knuckle.
struct Digit {
  std::vector<Bone> bones;  ///< from the knuckle to the tip
};

struct HandBones {
  std::vector<Bone> palm;  ///< wrist, metacarpals, the thumb's and the little finger's muscles, webs: one soft mass
  std::array<Digit, 5> digits;  ///< thumb, index, middle, ring, little
};

HandBones pose_bones(const HandPose& pose);

}  // namespace palpa::assets
