// Skin points: places on a hand's surface, from depth frames or other sources.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace palpa::sensing {

/// On the device, one vec4: x, y, z and the bits of the index.
struct SkinPoint {
  glm::vec3 position{};     ///< metres, world
  std::uint32_t index = 0;  ///< v * width + u, plus the pixels of the earlier cameras; from other sources its place in
                            ///< the list
};
static_assert(sizeof(SkinPoint) == 16);

/// Points whose index is their place in the list.
inline std::vector<SkinPoint> numbered(std::span<const glm::vec3> positions) {
  std::vector<SkinPoint> points(positions.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    points[i] = {positions[i], i};
  return points;
}

}  // namespace palpa::sensing
