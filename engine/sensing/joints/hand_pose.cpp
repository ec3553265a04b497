#include "sensing/joints/hand_pose.hpp"

#include <glm/geometric.hpp>

namespace palpa::sensing {

Transform pose_of_joint(const TrackedHand& hand, std::size_t joint) {
  const auto knuckle = [&](std::size_t finger) { return hand.joints[finger_joints[finger].first + 1]; };
  const Vec3 along = knuckle(2) - hand.joints[wrist_joint];
  const Vec3 across = hand.left ? knuckle(1) - knuckle(4) : knuckle(4) - knuckle(1);
  const Vec3 up = glm::cross(across, along);
  Transform pose(1.0);
  if (glm::length(up) > 0) {
    const Vec3 y = glm::normalize(along), z = glm::normalize(up);
    pose = Transform(Vec4(glm::cross(y, z), 0), Vec4(y, 0), Vec4(z, 0), Vec4(0, 0, 0, 1));
  }
  pose[3] = Vec4(hand.joints[joint], 1);
  return pose;
}

}  // namespace palpa::sensing
