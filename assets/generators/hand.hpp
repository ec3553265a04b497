// A posable right hand, about life size.
//
// The frame is the same for every pose: the wrist is fixed, 176 mm along +y from the tip of the straight index finger.
// Fingers point along -y, the palm faces -z, the thumb is on the +x side, and the forearm's stub runs along +y and has
// a rounded end. If the index finger is straight (all its angles zero, as in the `point` pose), its tip touches the
// origin and its body runs along +y, so the hand can replace the finger of finger.ply.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// Joint angles in radians, all zero when straight. Flexion bends towards the palm.
struct FingerPose {
  double mcp = 0;  ///< flexion of the knuckle
  double pip = 0;  ///< flexion of the middle joint
  double dip = 0;  ///< flexion of the last joint
  double abduction =
      0;  ///< sideways at the knuckle, spreading: index and middle finger towards the thumb, the others away from it
};

struct ThumbPose {
  double cmc = 0;        ///< flexion at the wrist's side, across the palm
  double mcp = 0;        ///< flexion of the knuckle
  double ip = 0;         ///< flexion of the last joint
  double abduction = 0;  ///< at the wrist's side, away from the palm's plane (towards -z)
};

struct HandPose {
  ThumbPose thumb;
  std::array<FingerPose, 4> fingers;  ///< index, middle, ring, little
};

/// "spread", "point", "relaxed" or "fist".
std::optional<HandPose> named_hand_pose(std::string_view name);

struct Fingertip {
  Vec3 position;   ///< on the skin, at the end of the last bone
  Vec3 direction;  ///< unit, outwards along that bone
  double radius;   ///< of the skin's curvature
};

/// Thumb, index, middle, ring, little.
std::array<Fingertip, 5> fingertips(const HandPose& pose);

/// The skin: one closed shell without handles or self-intersections, facing outwards. Neighbouring vertices are 1.2 mm
/// apart at the fingertips, growing to 3 mm. Coordinates are 32-bit floats. If a pose presses fingers against each
/// other or against the palm, they are flattened there and keep a gap. (If a pose drives parts deep into each other, as
/// no hand can, handles may remain; even then, the surface is closed and does not cross itself.) The same pose gives
/// the same bytes. It takes about a second.
geometry::Mesh make_hand(const HandPose& pose);

}  // namespace palpa::assets
