// Places the pixels of a depth image in the world, several at a time. Every processor gives the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "sensing/rays.hpp"

namespace palpa::sensing {

/// A box in world coordinates, in single precision.
struct Bounds {
  glm::vec3 low, high;
};

/// Neighbouring pixels of a row.
struct SkinPixels {
  static constexpr std::uint32_t most = 64;
  std::array<float, most> x, y, z;         ///< in the world
  std::array<std::uint32_t, most> is_out;  ///< not 0: outside the box, or outside the crop's depths
};

/// Places `count` (1 to SkinPixels::most) pixels that begin at `depth` and `rays`. Returns false if none is within the
/// crop's depths; then `out` is not written.
bool place_pixels(const Crop& crop, const Bounds& box, const std::uint16_t* depth, const glm::vec2* rays,
                  std::uint32_t count, SkinPixels& out);

}  // namespace palpa::sensing
