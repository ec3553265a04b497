#include "sensing/skin_twin.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "sensing/skin_pixels.hpp"
#include "shaders/sensing/skin_math.h"

namespace palpa::sensing {
namespace {

/// `limit`: of the point's pixel.
std::uint32_t why_dropped(std::span<const shader::SkinVolume> volumes, const glm::vec3& point, std::uint16_t raw,
                          std::uint16_t limit) {
  for (const shader::SkinVolume& volume : volumes) {
    if (shader::drops_point(volume, {point.x, point.y, point.z})) return volume.kind;
  }
  return raw > limit ? shader::skin_background : shader::skin_kept;
}

/// `limits`: of the camera's padded pixels; empty if it has no background.
void find_in_crop(const Crop& crop, const CameraTable& table, std::span<const glm::vec2> rays,
                  std::span<const std::uint16_t> depth, const Bounds& box, std::span<const shader::SkinVolume> volumes,
                  std::span<const std::uint16_t> limits, SkinOfFrame& out) {
  const bool all_skin = volumes.empty() && limits.empty();
  const std::uint32_t end_column = std::min(crop.first_column + crop.blocks_per_row * block_pixels, table.width);
  SkinPixels pixels;
  for (std::uint32_t v = crop.first_row; v < crop.first_row + crop.rows; ++v) {
    if (v % crop.stride != 0) continue;
    const std::uint16_t* row = depth.data() + std::size_t{v} * table.width;
    const glm::vec2* ray_row = rays.data() + table.first_pixel + std::size_t{v} * table.pitch;
    for (std::uint32_t first = crop.first_column; first < end_column; first += SkinPixels::most) {
      const std::uint32_t count = std::min(SkinPixels::most, end_column - first);
      if (!place_pixels(crop, box, row + first, ray_row + first, count, pixels)) continue;
      for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t u = first + n;
        if (pixels.is_out[n] != 0 || (crop.stride != 1 && u % crop.stride != 0)) continue;
        const SkinPoint point{{pixels.x[n], pixels.y[n], pixels.z[n]},
                              static_cast<std::uint32_t>(table.first_index) + v * table.width + u};
        if (!all_skin) {
          const std::uint16_t limit = limits.empty() ? 65535 : limits[std::size_t{v} * table.pitch + u];
          const std::uint32_t why = why_dropped(volumes, point.position, row[u], limit);
          if (why != shader::skin_kept) {
            ++out.dropped.counts[why];
            if (out.wants_leavings) out.leavings.push_back(point);
            continue;
          }
        }
        out.points.push_back(point);
      }
    }
  }
}

}  // namespace

void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::span<const shader::SkinVolume> volumes, SkinOfFrame& out) {
  out.points.clear();
  out.leavings.clear();
  out.dropped = {};
  check_frames(tables, frames);
  const Bounds bounds{glm::vec3(box.low), glm::vec3(box.high)};
  for (const Crop& crop : crops) {
    const CameraTable& table = tables.cameras[crop.camera];
    const auto limits =
        table.background ? std::span(tables.limits).subspan(table.first_pixel) : std::span<const std::uint16_t>();
    find_in_crop(crop, table, tables.rays, frames[crop.camera].depth, bounds, volumes, limits, out);
  }
}

void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::vector<SkinPoint>& out) {
  SkinOfFrame found;
  found.points.swap(out);
  find_skin(tables, frames, box, crops, {}, found);
  out.swap(found.points);
}

bool is_skin(const RayTables& tables, std::span<const shader::SkinVolume> volumes, const PixelPoint& point) {
  const CameraTable& table = tables.cameras[point.camera];
  const std::size_t pixel = table.first_pixel + std::size_t{point.v} * table.pitch + point.u;
  const std::uint16_t limit = table.background ? tables.limits[pixel] : 65535;
  return why_dropped(volumes, point.position, point.raw, limit) == shader::skin_kept;
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
