#include "session/predict/skin_step.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "sensing/skin_twin.hpp"

namespace palpa::session {
namespace {

constexpr std::size_t most_samples = 480;   ///< of all cameras together, about
constexpr std::uint32_t normal_pixels = 2;  ///< to the neighbours that give a normal
constexpr double most_slope_m = 6e-3;       ///< depth between these neighbours; more is a rim
constexpr double first_reach_m = 8e-3;      ///< farther along the normal is another surface
constexpr double last_reach_m = 2e-3;       ///< in the last of the rounds
constexpr int rounds = 4;
/// Skin that has come into the box was at most this far from it in the frame before.
constexpr double most_step_m = 50e-3;
constexpr double hold_of_centroid = 0.01;  ///< weight of the centroid's way, relative to that of all normals

/// One camera's image in its own coordinates.
struct Image {
  std::size_t number;
  const sensing::Camera& camera;
  const sensing::CameraTable& table;
  const sensing::RayTables& tables;
  const std::vector<std::uint16_t>& depth;

  std::uint16_t raw_at(std::uint32_t u, std::uint32_t v) const { return depth[std::size_t{v} * table.width + u]; }
  std::optional<Vec3> at(std::uint32_t u, std::uint32_t v) const {
    if (u >= table.width || v >= table.height) return std::nullopt;
    const std::uint16_t raw = raw_at(u, v);
    const glm::vec2& ray = tables.rays[table.first_pixel + std::size_t{v} * table.pitch + u];
    if (raw == 0 || ray.x >= sensing::no_ray) return std::nullopt;
    const double z = raw * camera.depth_unit_m;
    return Vec3(ray.x * z, ray.y * z, z);
  }
  /// In the world.
  std::optional<Vec3> place_at(std::uint32_t u, std::uint32_t v) const {
    const std::optional<Vec3> point = at(u, v);
    if (!point) return std::nullopt;
    return transform_point(camera.T_world_camera, *point);
  }
  /// Whether the pixel with this place shows skin.
  bool is_skin(std::uint32_t u, std::uint32_t v, const Vec3& place, std::span<const shader::SkinVolume> volumes) const {
    return sensing::is_skin(tables, volumes, {number, u, v, raw_at(u, v), glm::vec3(place)});
  }
  /// Towards the camera.
  std::optional<Vec3> normal_at(std::uint32_t u, std::uint32_t v) const {
    constexpr std::uint32_t far = normal_pixels;
    if (u < far || v < far) return std::nullopt;
    const auto left = at(u - far, v), right = at(u + far, v), above = at(u, v - far), below = at(u, v + far);
    if (!left || !right || !above || !below) return std::nullopt;
    if (std::abs(left->z - right->z) > most_slope_m || std::abs(above->z - below->z) > most_slope_m)
      return std::nullopt;
    const Vec3 normal = glm::cross(*below - *above, *right - *left);
    const double length = glm::length(normal);
    if (!(length > 0)) return std::nullopt;
    return normal * ((normal.z > 0 ? -1 : 1) / length);
  }
};

Image image_of(const CameraView& view, const KeptFrames& frames, std::size_t c) {
  return {c, view.cameras[c], view.tables.cameras[c], view.tables, frames.images()[c].depth};
}

void find_samples(const CameraView& view, const KeptFrames& now, const Box& box, SkinScratch& scratch) {
  std::vector<sensing::Crop>& crops = scratch.crops;
  scratch.samples.clear();
  sensing::plan_crops(view.cameras, view.tables, box, crops);
  std::size_t pixels = 0;
  for (const sensing::Crop& crop : crops)
    pixels += std::size_t{crop.blocks()} * sensing::block_pixels;
  // The skin covers perhaps a half of them.
  const auto step = static_cast<std::uint32_t>(
      std::max(1.0, std::ceil(std::sqrt(static_cast<double>(pixels) / (2.0 * most_samples)))));
  for (const sensing::Crop& crop : crops) {
    const Image image = image_of(view, now, crop.camera);
    const std::uint32_t last =
        std::min(crop.first_column + crop.blocks_per_row * sensing::block_pixels, image.table.width);
    for (std::uint32_t v = crop.first_row; v < crop.first_row + crop.rows; v += step) {
      for (std::uint32_t u = crop.first_column; u < last; u += step) {
        const auto place = image.place_at(u, v);
        if (!place || !box.contains(*place) || !image.is_skin(u, v, *place, scratch.volumes)) continue;
        if (const auto normal = image.normal_at(u, v)) {
          scratch.samples.push_back({*place, glm::dmat3(image.camera.T_world_camera) * *normal, crop.camera});
        }
      }
    }
  }
}

}  // namespace

SkinStep find_skin_step(const CameraView& view, const KeptFrames& now, const KeptFrames& before, const Box& box,
                        const Vec3& expected, const Vec3& centroid, SkinScratch& scratch) {
  if (!now.any() || !before.any()) return {};
  scratch.volumes.clear();
  if (view.surroundings)
    sensing::plan_drops(*view.surroundings, {box.low - most_step_m, box.high + most_step_m}, scratch.volumes);
  find_samples(view, now, box, scratch);
  SkinStep step{expected, 0};
  scratch.T_camera_world.clear();
  for (const sensing::Camera& camera : view.cameras)
    scratch.T_camera_world.push_back(glm::inverse(camera.T_world_camera));
  for (int round = 0; round < rounds; ++round) {
    const double reach_m = first_reach_m + (last_reach_m - first_reach_m) * round / (rounds - 1);
    glm::dmat3 normals(0);
    Vec3 ways(0);
    std::size_t count = 0;
    for (const SkinSample& sample : scratch.samples) {
      const Vec3 from = sample.place - step.way;
      const Vec3 seen = transform_point(scratch.T_camera_world[sample.camera], from);
      if (!(seen.z > 0)) continue;
      const Vec2 pixel = sensing::project(view.cameras[sample.camera], seen);
      const Image image = image_of(view, before, sample.camera);
      if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x < image.table.width && pixel.y < image.table.height)) continue;
      const auto u = static_cast<std::uint32_t>(std::floor(pixel.x + 0.5));
      const auto v = static_cast<std::uint32_t>(std::floor(pixel.y + 0.5));
      const auto old = image.place_at(u, v);
      const Vec3& n = sample.normal;
      if (!old || std::abs(glm::dot(n, from - *old)) > reach_m) continue;
      if (!image.is_skin(u, v, *old, scratch.volumes)) continue;
      ++count;
      normals += glm::outerProduct(n, n);
      ways += n * glm::dot(n, sample.place - *old);
    }
    step.samples = count;
    if (count < least_skin_samples) return step;
    const double weight = hold_of_centroid * static_cast<double>(count);
    for (int i = 0; i < 3; ++i)
      normals[i][i] += weight;
    step.way = glm::inverse(normals) * (ways + weight * centroid);
  }
  return step;
}

}  // namespace palpa::session
