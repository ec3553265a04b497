#include "assets/generators/hand_bones.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace palpa::assets {
namespace {

constexpr double kMm = 1e-3;

struct FingerAnatomy {
  Vec3 knuckle;                   ///< millimetres, like all lengths here
  Vec3 carpal;                    ///< where its metacarpal begins
  std::array<double, 3> lengths;  ///< of the bones; the last ends at the centre of the tip's ball
  std::array<double, 4> radii;    ///< at knuckle, middle joint, last joint, tip
  double spread_sign;             ///< +1 if abduction turns towards +x
};

// Lengths add up so that the straight index finger's skin ends at the origin: 42 + 25 + 15.2 + 7.8 = 90.
const std::array<FingerAnatomy, 4> kFingers{{
    {{0, 90, 0}, {-14, 163, 0}, {42, 25, 15.2}, {10.4, 9.9, 8.9, 7.8}, 1},
    {{-21, 87, 2}, {-23, 163, 1}, {46, 29, 16}, {10.6, 10.1, 9.1, 8.1}, 1},
    {{-41, 91, 1}, {-31, 163, 1}, {42.5, 27, 16}, {10.0, 9.5, 8.6, 7.7}, -1},
    {{-58, 99, -3}, {-38, 162, -1}, {34, 19.5, 14.5}, {9.0, 8.5, 7.8, 7.0}, -1},
}};
constexpr double kCarpalRadius = 12.5;
constexpr double kWebReach = 0.42;  ///< of the first bone: how far the skin between two fingers reaches along them

const Vec3 kThumbRoot{-4, 157, -7};
constexpr std::array<double, 3> kThumbLengths{48, 32, 18.5};
constexpr std::array<double, 4> kThumbRadii{12, 11.8, 10.6, 8.9};
// When straight, the thumb stands off the index finger; when it flexes, it crosses the palm towards the little finger.
const Vec3 kThumbDirection{0.66, -0.70, -0.27};
const Vec3 kThumbFlexesTowards{-0.75, -0.10, -0.65};

/// The skin between thumb and index finger, as rods: their beginnings on the thumb's metacarpal and ends on the index
/// finger's, as fractions, and their radii.
constexpr std::array<std::array<double, 3>, 5> kThumbWeb{
    {{0.30, 0.36, 10.0}, {0.44, 0.46, 9.2}, {0.58, 0.56, 8.4}, {0.72, 0.66, 7.6}, {0.86, 0.76, 6.8}}};

Vec3 rotate(const Vec3& v, double angle, const Vec3& axis) {
  return Vec3(glm::rotate(glm::dmat4(1.0), angle, axis) * Vec4(v, 0.0));
}

Vec3 along(const Bone& bone, double fraction) {
  return bone.a + (bone.b - bone.a) * fraction;
}

Bone scaled(const Vec3& a, const Vec3& b, double radius_a, double radius_b) {
  return {a * kMm, b * kMm, radius_a * kMm, radius_b * kMm};
}

void add_finger(HandBones& hand, int which, const FingerPose& pose) {
  const FingerAnatomy& finger = kFingers[which];
  const double sideways = finger.spread_sign * pose.abduction;
  const Vec3 axis = rotate({1, 0, 0}, sideways, {0, 0, 1});
  Vec3 direction = rotate({0, -1, 0}, sideways, {0, 0, 1}), joint = finger.knuckle;
  hand.palm.push_back(scaled(finger.carpal, finger.knuckle, kCarpalRadius, finger.radii[0]));
  const std::array<double, 3> flexion{pose.mcp, pose.pip, pose.dip};
  for (int i = 0; i < 3; ++i) {
    direction = rotate(direction, flexion[i], axis);
    const Vec3 next = joint + direction * finger.lengths[i];
    hand.digits[which + 1].bones.push_back(scaled(joint, next, finger.radii[i], finger.radii[i + 1]));
    joint = next;
  }
}

/// The flesh between two neighbouring metacarpals, and the skin that spans the roots of their fingers.
void add_webs(HandBones& hand) {
  for (int finger = 0; finger < 3; ++finger) {
    const FingerAnatomy &one = kFingers[finger], &other = kFingers[finger + 1];
    hand.palm.push_back(scaled(0.5 * (one.carpal + other.carpal), 0.5 * (one.knuckle + other.knuckle) + Vec3(0, 6, -2),
                               kCarpalRadius, 10.0));
    const Bone &first = hand.digits[finger + 1].bones[0], &second = hand.digits[finger + 2].bones[0];
    const Vec3 reach = 0.5 * (along(first, kWebReach) + along(second, kWebReach));
    hand.palm.push_back({0.5 * (first.a + second.a), reach, 8.0 * kMm, 5.0 * kMm});
  }
}

void add_thumb(HandBones& hand, const ThumbPose& pose) {
  Vec3 direction = glm::normalize(kThumbDirection);
  const Vec3 across = glm::normalize(kThumbFlexesTowards - direction * glm::dot(kThumbFlexesTowards, direction));
  Vec3 axis = glm::normalize(glm::cross(direction, across));
  direction = rotate(direction, -pose.abduction, across);
  axis = rotate(axis, -pose.abduction, across);
  direction = rotate(direction, pose.cmc, axis);

  const Vec3 knuckle = kThumbRoot + direction * kThumbLengths[0];
  hand.palm.push_back(scaled(kThumbRoot, knuckle, kThumbRadii[0], kThumbRadii[1] + 0.5));
  const Bone metacarpal = hand.palm.back();
  // The ball of the thumb, between its metacarpal and the palm.
  hand.palm.push_back(scaled({-13, 152, -8}, along(metacarpal, 0.62) / kMm + Vec3(-7, 4, -1), 14.5, 11.5));
  // The skin between thumb and index finger: a fan.
  const Bone index = hand.palm[0];  // its metacarpal
  for (const auto& [from, to, radius] : kThumbWeb)
    hand.palm.push_back({along(metacarpal, from), along(index, to), radius * kMm, radius * kMm});

  direction = rotate(direction, pose.mcp, axis);
  const Vec3 middle = knuckle + direction * kThumbLengths[1];
  hand.digits[0].bones.push_back(scaled(knuckle, middle, kThumbRadii[1], kThumbRadii[2]));
  direction = rotate(direction, pose.ip, axis);
  hand.digits[0].bones.push_back(scaled(middle, middle + direction * kThumbLengths[2], kThumbRadii[2], kThumbRadii[3]));
}

}  // namespace

double distance(const Bone& bone, const Vec3& point) {
  // In the half plane through the axis, the cone's side touches both balls. So it begins and ends where the slanted
  // normal meets the ends of the axis.
  const Vec3 axis = bone.b - bone.a, from_a = point - bone.a;
  const double length = glm::length(axis);
  const double along = glm::dot(from_a, axis) / length;
  const double across = std::sqrt(std::max(0.0, glm::dot(from_a, from_a) - along * along));
  const double sine = (bone.radius_a - bone.radius_b) / length;  // of the side's slant
  const double cosine = std::sqrt(1.0 - sine * sine);
  const double foot = along - across * sine / cosine;  // the point of the axis whose ball is nearest
  if (foot <= 0.0) return glm::length(from_a) - bone.radius_a;
  if (foot >= length) return glm::length(point - bone.b) - bone.radius_b;
  return across * cosine + along * sine - bone.radius_a;
}

HandBones pose_bones(const HandPose& pose) {
  HandBones hand;
  for (int finger = 0; finger < 4; ++finger)
    add_finger(hand, finger, pose.fingers[finger]);
  hand.palm.push_back(scaled({-42, 153, -7}, {-57, 105, -5}, 12.5, 8.5));  // the ball of the little finger
  // Wrist and forearm: three rods side by side make a flat oval.
  hand.palm.push_back(scaled({-14, 172, 0}, {-12, 216, 0}, 15, 19));
  hand.palm.push_back(scaled({-26, 172, 0}, {-26, 216, 0}, 15.5, 21.5));
  hand.palm.push_back(scaled({-38, 172, 0}, {-40, 216, 0}, 14.5, 19));
  add_thumb(hand, pose.thumb);
  add_webs(hand);
  return hand;
}

std::array<Fingertip, 5> fingertips(const HandPose& pose) {
  const HandBones hand = pose_bones(pose);
  std::array<Fingertip, 5> tips;
  for (int i = 0; i < 5; ++i) {
    const Bone& last = hand.digits[i].bones.back();
    const Vec3 direction = glm::normalize(last.b - last.a);
    tips[i] = {last.b + direction * last.radius_b, direction, last.radius_b};
  }
  return tips;
}

}  // namespace palpa::assets
