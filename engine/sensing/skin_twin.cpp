#include "sensing/skin_twin.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"

namespace palpa::sensing {
namespace {

void find_in_crop(const Crop& crop, const CameraTable& table, std::span<const glm::vec2> rays,
                  std::span<const std::uint16_t> depth, const glm::vec3& low, const glm::vec3& high,
                  std::vector<SkinPoint>& out) {
  const auto& pose = crop.rows_of_pose;
  const std::uint32_t span = crop.depth_high - crop.depth_low;
  const std::uint32_t end_column = std::min(crop.first_column + crop.blocks_per_row * block_pixels, table.width);
  for (std::uint32_t v = crop.first_row; v < crop.first_row + crop.rows; ++v) {
    if (v % crop.stride != 0) continue;
    const std::uint16_t* row = depth.data() + std::size_t{v} * table.width;
    const glm::vec2* ray_row = rays.data() + table.first_pixel + std::size_t{v} * table.pitch;
    for (std::uint32_t u = crop.first_column; u < end_column; ++u) {
      if (row[u] - crop.depth_low > span || u % crop.stride != 0) continue;
      const float z = static_cast<float>(row[u]) * crop.depth_unit;
      const float x = ray_row[u].x * z, y = ray_row[u].y * z;
      glm::vec3 world;
      for (int i = 0; i < 3; ++i)
        world[i] = ((pose[i][0] * x + pose[i][1] * y) + pose[i][2] * z) + pose[i][3];
      if (world.x < low.x || world.y < low.y || world.z < low.z || world.x > high.x || world.y > high.y ||
          world.z > high.z) {
        continue;
      }
      out.push_back({world, static_cast<std::uint32_t>(table.first_index) + v * table.width + u});
    }
  }
}

}  // namespace

void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::vector<SkinPoint>& out) {
  out.clear();
  for (std::size_t i = 0; i < tables.cameras.size(); ++i) {
    const CameraTable& table = tables.cameras[i];
    if (frames.size() != tables.cameras.size() || frames[i].depth.size() != std::size_t{table.width} * table.height) {
      throw bad_usage(fmt::format("the depth frames do not fit the {} cameras", tables.cameras.size()));
    }
  }
  const glm::vec3 low(box.low), high(box.high);
  for (const Crop& crop : crops) {
    find_in_crop(crop, tables.cameras[crop.camera], tables.rays, frames[crop.camera].depth, low, high, out);
  }
}

std::vector<SkinPoint> find_skin(std::span<const Camera> cameras, std::span<const DepthFrame> frames, const Box& box) {
  const RayTables tables = make_rays(cameras);
  std::vector<Crop> crops;
  plan_crops(cameras, tables, box, crops);
  std::vector<SkinPoint> out;
  find_skin(tables, frames, box, crops, out);
  return out;
}

}  // namespace palpa::sensing
