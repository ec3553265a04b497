#include "sensing/skin_pixels.hpp"

#include "base/lanes.hpp"

namespace palpa::sensing {
namespace {

[[gnu::always_inline]] inline bool place(const Crop& crop, const Bounds& box, const std::uint16_t* depth,
                                         const glm::vec2* rays, std::uint32_t count, SkinPixels& __restrict out) {
  const std::uint32_t least = crop.depth_low, span = crop.depth_high - least;
  std::uint32_t within = 0;
  for (std::uint32_t n = 0; n < count; ++n)
    within += depth[n] - least <= span ? 1U : 0U;
  if (within == 0) return false;
  const auto& pose = crop.rows_of_pose;
  const float unit = crop.depth_unit;
  const glm::vec3 low = box.low, high = box.high;
  for (std::uint32_t n = 0; n < count; ++n) {
    const float z = static_cast<float>(depth[n]) * unit;
    const float x = rays[n].x * z, y = rays[n].y * z;
    const float wx = ((pose[0][0] * x + pose[0][1] * y) + pose[0][2] * z) + pose[0][3];
    const float wy = ((pose[1][0] * x + pose[1][1] * y) + pose[1][2] * z) + pose[1][3];
    const float wz = ((pose[2][0] * x + pose[2][1] * y) + pose[2][2] * z) + pose[2][3];
    out.x[n] = wx;
    out.y[n] = wy;
    out.z[n] = wz;
    std::uint32_t is_out = depth[n] - least > span ? 1U : 0U;
    is_out |= wx < low.x ? 1U : 0U;
    is_out |= wy < low.y ? 1U : 0U;
    is_out |= wz < low.z ? 1U : 0U;
    is_out |= wx > high.x ? 1U : 0U;
    is_out |= wy > high.y ? 1U : 0U;
    is_out |= wz > high.z ? 1U : 0U;
    out.is_out[n] = is_out;
  }
  return true;
}

}  // namespace

bool place_pixels(const Crop& crop, const Bounds& box, const std::uint16_t* depth, const glm::vec2* rays,
                  std::uint32_t count, SkinPixels& out) {
  return in_lanes([&](auto) PALPA_INLINED { return place(crop, box, depth, rays, count, out); });
}

}  // namespace palpa::sensing
