#include "support/hand_skin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include "assets/generators/hand_bones.hpp"
#include "geometry/files/ply.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// The part whose bone is nearest.
std::uint32_t part_at(const assets::HandBones& bones, const Vec3& p) {
  std::uint32_t best = palm_part;
  double nearest = 1e9;
  for (const assets::Bone& bone : bones.palm)
    nearest = std::min(nearest, assets::distance(bone, p));
  for (std::uint32_t d = 0; d < palm_part; ++d) {
    for (const assets::Bone& bone : bones.digits[d].bones) {
      const double apart = assets::distance(bone, p);
      if (apart < nearest) nearest = apart, best = d;
    }
  }
  return best;
}

HandSkin make_skin(const assets::HandPose& pose) {
  HandSkin skin{assets::make_hand(pose), {}, hand_parts};
  const assets::HandBones bones = assets::pose_bones(pose);
  for (const Vec3& p : skin.mesh.positions)
    skin.part.push_back(part_at(bones, p));
  return skin;
}

HandSkin mirrored(HandSkin skin) {
  for (Vec3& p : skin.mesh.positions)
    p.x = -p.x;
  for (auto& triangle : skin.mesh.triangles)
    std::swap(triangle[1], triangle[2]);
  return skin;
}

using Key = std::array<double, 21>;

Key key_of(const assets::HandPose& pose, bool left) {
  Key key{pose.thumb.cmc, pose.thumb.mcp, pose.thumb.ip, pose.thumb.abduction};
  std::size_t n = 4;
  for (const assets::FingerPose& finger : pose.fingers) {
    for (const double angle : {finger.mcp, finger.pip, finger.dip, finger.abduction})
      key[n++] = angle;
  }
  key[n] = left ? 1 : 0;
  return key;
}

struct Made {
  std::once_flag once;
  HandSkin skin;
};

}  // namespace

const HandSkin& hand_skin(const assets::HandPose& pose, bool left) {
  static std::mutex mutex;
  static std::map<Key, std::unique_ptr<Made>> skins;
  Made* made = nullptr;
  {
    const std::lock_guard lock(mutex);
    std::unique_ptr<Made>& at = skins[key_of(pose, left)];
    if (!at) at = std::make_unique<Made>();
    made = at.get();
  }
  std::call_once(made->once, [&] { made->skin = left ? mirrored(hand_skin(pose)) : make_skin(pose); });
  return made->skin;
}

const HandSkin& finger_skin() {
  static const HandSkin skin = [] {
    geometry::Ply ply = geometry::read_ply(source_file("assets/finger.ply"));
    HandSkin made{{std::move(ply.positions), std::move(ply.triangles)}, {}, 1};
    made.part.assign(made.mesh.positions.size(), 0);
    return made;
  }();
  return skin;
}

Transform rotation(const Vec3& axis, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  const auto turn = [&](const Vec3& v) { return v * c + glm::cross(axis, v) * s + axis * glm::dot(axis, v) * (1 - c); };
  return Transform(Vec4(turn({1, 0, 0}), 0), Vec4(turn({0, 1, 0}), 0), Vec4(turn({0, 0, 1}), 0), Vec4(0, 0, 0, 1));
}

Transform turned(const Vec3& axis, double degrees) {
  return rotation(axis, degrees * std::numbers::pi / 180);
}

Transform pressed(const geometry::Mesh& mesh, Transform T, double press) {
  double lowest = 1e9;
  for (const Vec3& p : mesh.positions)
    lowest = std::min(lowest, transform_point(T, p).y);
  T[3].y -= lowest + press;
  return T;
}

}  // namespace palpa::test
