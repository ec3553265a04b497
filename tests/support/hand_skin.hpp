// The skin of hands and of the finger of assets/finger.ply, made once per program, and how it is placed on a surface.
// Any thread may call these functions.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/generators/hand.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::test {

/// The parts of a hand: thumb, index, middle, ring, little, and the palm with the forearm.
inline constexpr std::uint32_t hand_parts = 6, palm_part = 5;

/// A shape of skin, and the part of it that each vertex belongs to. The parts of a hand are its digits and its palm; a
/// single finger is one part.
struct HandSkin {
  geometry::Mesh mesh;
  std::vector<std::uint32_t> part;
  std::uint32_t parts = 1;
};

/// assets::make_hand, or its mirror image.
const HandSkin& hand_skin(const assets::HandPose& pose, bool left = false);
/// Tip at the origin, body along +y, 18 mm thick.
const HandSkin& finger_skin();

/// A rotation about a unit vector through the origin.
Transform rotation(const Vec3& axis, double radians);
Transform turned(const Vec3& axis, double degrees);
/// `T` lowered until the lowest point of the mesh lies `press` below y = 0.
Transform pressed(const geometry::Mesh& mesh, Transform T, double press);

}  // namespace palpa::test
