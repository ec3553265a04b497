#include "assets/generators/hand.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "assets/generators/hand_field.hpp"
#include "assets/generators/remesh.hpp"
#include "assets/generators/shape.hpp"

namespace palpa::assets {
namespace {

constexpr double kCell = 1.5e-3;  ///< of the first surface; its diagonal is the gap between fingers, 2.6 mm
constexpr double kFineSize = 1.2e-3, kCoarseSize = 3.0e-3, kGrowth = 0.1, kFineReach = 9e-3;

HandPose make_pose(const ThumbPose& thumb, const FingerPose& index, const FingerPose& middle, const FingerPose& ring,
                   const FingerPose& little) {
  return {thumb, {index, middle, ring, little}};
}

}  // namespace

std::optional<HandPose> named_hand_pose(std::string_view name) {
  if (name == "spread")
    return make_pose({-0.10, 0.10, 0.10, 0.10}, {0.05, 0.08, 0.05, 0.22}, {0.05, 0.08, 0.05, 0.03},
                     {0.05, 0.08, 0.05, 0.20}, {0.05, 0.10, 0.05, 0.42});
  if (name == "point")
    return make_pose({0.70, 0.20, 0.70, -0.25}, {}, {1.25, 1.70, 1.05, 0.0}, {1.30, 1.70, 1.05, 0.0},
                     {1.30, 1.65, 1.05, 0.02});
  if (name == "relaxed")
    return make_pose({0.30, 0.20, 0.30, 0.0}, {0.40, 0.55, 0.30, 0.06}, {0.50, 0.65, 0.35, 0.02},
                     {0.58, 0.70, 0.38, 0.04}, {0.65, 0.70, 0.38, 0.10});
  if (name == "fist")
    return make_pose({0.60, 0.30, 0.80, 0.05}, {1.40, 1.70, 1.05, 0.0}, {1.40, 1.72, 1.05, 0.0},
                     {1.40, 1.72, 1.05, 0.0}, {1.40, 1.68, 1.05, 0.02});
  return std::nullopt;
}

geometry::Mesh make_hand(const HandPose& pose) {
  const HandField skin(pose_bones(pose));
  const std::array<Fingertip, 5> tips = fingertips(pose);
  const Field field = [&](const Vec3& p) { return skin(p); };
  const Sizing sizing = [&](const Vec3& p) {
    double nearest = std::numeric_limits<double>::max();
    for (const Fingertip& tip : tips)
      nearest = std::min(nearest, glm::distance(p, tip.position));
    return std::clamp(kFineSize + kGrowth * (nearest - kFineReach), kFineSize, kCoarseSize);
  };
  // Parts that are strongly pressed together can separate a small piece.
  geometry::Mesh mesh = remesh(largest_shell(isosurface(field, skin.bounds(), kCell)), field, sizing);
  round_to_float(mesh);
  return mesh;
}

}  // namespace palpa::assets
