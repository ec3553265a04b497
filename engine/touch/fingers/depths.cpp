#include "touch/fingers/depths.hpp"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace palpa::touch {
namespace {

struct Bounds {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
};

/// Squared metres; 0 inside.
float apart(const Bounds& bounds, const glm::vec3& point) {
  const glm::vec3 nearest = glm::clamp(point, bounds.low, bounds.high);
  return glm::dot(point - nearest, point - nearest);
}

float squared(const glm::vec3& v) {
  return glm::dot(v, v);
}

/// The greater of a finger's depth and that of one of its points.
float deeper(const Sight& sight, float depth, const Contact& point) {
  if (point.depth_m <= depth || !(sight.cameras.empty() || is_firm(sight, point.point))) return depth;
  return point.depth_m;
}

}  // namespace

void find_depths(const Sight& sight, Touch& touch) {
  std::array<Bounds, max_fingers> bounds;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    Finger& finger = touch.fingers[f];
    finger.depth_m = 0;
    for (const std::uint32_t index : finger.contacts) {
      const Contact& contact = touch.contacts[index];
      finger.depth_m = deeper(sight, finger.depth_m, contact);
      bounds[f].low = glm::min(bounds[f].low, contact.position);
      bounds[f].high = glm::max(bounds[f].high, contact.position);
    }
  }
  for (const Contact& deep : touch.deep) {
    std::uint32_t nearest = touch.finger_count;
    float least = deep_reach_m * deep_reach_m, least_centroid = 0;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      if (finger.solid != deep.solid) continue;
      const float distance = apart(bounds[f], deep.position);
      const float centroid = squared(finger.section.centroid - deep.position);
      if (distance > least || (distance == least && nearest != touch.finger_count && centroid >= least_centroid))
        continue;
      nearest = f;
      least = distance;
      least_centroid = centroid;
    }
    if (nearest == touch.finger_count) continue;
    float& depth = touch.fingers[nearest].depth_m;
    depth = deeper(sight, depth, deep);
  }
}

}  // namespace palpa::touch
