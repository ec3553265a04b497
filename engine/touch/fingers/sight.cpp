#include "touch/fingers/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <optional>

namespace palpa::touch {
namespace {

/// Pixels to either side that give the skin's normal.
constexpr std::uint32_t normal_pixels = 2;
/// The upper bits of a hash of their skin points sort contacts into most_samples buckets; each bucket keeps the contact
/// with the least hash.
constexpr std::uint32_t sample_shift = 26;
constexpr std::uint32_t sample_hash = 0x9e3779b1;
static_assert(most_samples == 1U << (32 - sample_shift));

/// `v` turned by a pose.
glm::vec3 rotated(const glm::mat4& pose, const glm::vec3& v) {
  return glm::mat3(pose) * v;
}

/// A pixel's point in camera coordinates. The depth is 0 if there is no data or no ray, or if the camera ignores the
/// pixel.
glm::vec3 point_of(const Sight& sight, std::size_t c, std::uint32_t u, std::uint32_t v) {
  const SightCamera& camera = sight.cameras[c];
  const glm::vec2& ray = sight.tables.rays[camera.first_pixel + std::size_t{v} * camera.pitch + u];
  const std::uint32_t raw = raw_at(sight, c, u, v);
  const bool has_data = raw >= camera.first_depth && ray.x != sensing::no_ray;
  const float depth = has_data ? static_cast<float>(raw) * camera.depth_unit : 0;
  return {ray.x * depth, ray.y * depth, depth};
}

/// From one neighbour to the other if both are on the surface, else between one of them and the pixel; 0 if neither is.
glm::vec3 tangent(const glm::vec3& at, const glm::vec3& before, const glm::vec3& after) {
  const auto on_surface = [&](const glm::vec3& p) { return p.z > 0 && std::abs(at.z - p.z) <= surface_step_m; };
  return (on_surface(after) ? after : at) - (on_surface(before) ? before : at);
}

}  // namespace

std::vector<SightCamera> sight_cameras(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables) {
  std::vector<SightCamera> out;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const sensing::Camera& camera = cameras[i];
    const sensing::CameraTable& table = tables.cameras[i];
    const auto single = [](double value) { return static_cast<float>(value); };
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    out.push_back({.T_world_camera = glm::mat4(camera.T_world_camera),
                   .T_camera_world = glm::mat4(glm::inverse(camera.T_world_camera)),
                   .fx = single(camera.fx),
                   .fy = single(camera.fy),
                   .cx = single(camera.cx),
                   .cy = single(camera.cy),
                   .k1 = single(k1),
                   .k2 = single(k2),
                   .p1 = single(p1),
                   .p2 = single(p2),
                   .k3 = single(k3),
                   .reach = table.reach * 1.01F,  // a little more for rounding
                   .depth_unit = single(camera.depth_unit_m),
                   .first_depth = sensing::first_valid_depth(camera),
                   .width = table.width,
                   .height = table.height,
                   .pitch = table.pitch,
                   .first_pixel = static_cast<std::uint32_t>(table.first_pixel),
                   .first_index = static_cast<std::uint32_t>(table.first_index)});
  }
  return out;
}

std::uint32_t raw_at(const Sight& sight, std::size_t camera, std::uint32_t u, std::uint32_t v) {
  return sight.images[camera].depth[std::size_t{v} * sight.cameras[camera].width + u];
}

SeenPixel pixel_of(const Sight& sight, std::uint32_t point) {
  std::size_t c = 0;
  while (c + 1 < sight.cameras.size() && point >= sight.cameras[c + 1].first_index)
    ++c;
  const SightCamera& camera = sight.cameras[c];
  const std::uint32_t pixel = point - camera.first_index;
  return {c, pixel % camera.width, pixel / camera.width};
}

glm::vec3 seen_from(const SightCamera& camera, const glm::vec3& world) {
  return rotated(camera.T_camera_world, world) + glm::vec3(camera.T_camera_world[3]);
}

Appearance appearance(const SightCamera& camera, const glm::vec3& world) {
  const glm::vec3 p = seen_from(camera, world);
  if (!(p.z > 1e-3F)) return {};
  const float x = p.x / p.z, y = p.y / p.z;
  const float r2 = x * x + y * y;
  if (!(r2 <= camera.reach)) return {};
  const float radial = 1.0F + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
  const float xd = x * radial + 2.0F * camera.p1 * x * y + camera.p2 * (r2 + 2.0F * x * x);
  const float yd = y * radial + camera.p1 * (r2 + 2.0F * y * y) + 2.0F * camera.p2 * x * y;
  const float u = std::floor(camera.fx * xd + camera.cx + 0.5F), v = std::floor(camera.fy * yd + camera.cy + 0.5F);
  const bool in_picture =
      u >= 0 && v >= 0 && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height);
  if (!in_picture) return {};
  return {static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v), p.z};
}

float noise_at(float depth) {
  // Metres, and an addition per square metre of distance.
  return 1e-3F + 5e-3F * depth * depth;
}

bool is_firm(const Sight& sight, std::uint32_t point) {
  constexpr std::uint32_t reach = 2, window = 5, company = 5;
  const SeenPixel p = pixel_of(sight, point);
  const SightCamera& camera = sight.cameras[p.camera];
  const auto depth_of = [&](std::uint32_t raw) { return static_cast<float>(raw) * camera.depth_unit; };
  const float at = depth_of(raw_at(sight, p.camera, p.u, p.v));
  std::uint32_t near = 0;
  for (std::uint32_t v = p.v; v < p.v + window; ++v) {
    for (std::uint32_t u = p.u; u < p.u + window; ++u) {  // both too large by `reach`
      if (u < reach || v < reach || u - reach >= camera.width || v - reach >= camera.height) continue;
      const std::uint32_t raw = raw_at(sight, p.camera, u - reach, v - reach);
      if (raw >= camera.first_depth && std::abs(at - depth_of(raw)) <= noise_at(at)) ++near;
    }
  }
  return near >= company;
}

void part_flying(const Sight& sight, std::vector<sensing::SkinPoint>& points, std::vector<sensing::SkinPoint>& flying) {
  std::erase_if(points, [&](const sensing::SkinPoint& point) {
    const bool flies = !is_firm(sight, point.index);
    if (flies) flying.push_back(point);
    return flies;
  });
}

glm::vec3 normal_at(const Sight& sight, std::uint32_t point) {
  const auto [c, u, v] = pixel_of(sight, point);
  const SightCamera& camera = sight.cameras[c];
  constexpr std::uint32_t far = normal_pixels;
  const glm::vec3 nothing{0};
  const glm::vec3 at = point_of(sight, c, u, v);
  const glm::vec3 across = tangent(at, u >= far ? point_of(sight, c, u - far, v) : nothing,
                                   u + far < camera.width ? point_of(sight, c, u + far, v) : nothing);
  const glm::vec3 down = tangent(at, v >= far ? point_of(sight, c, u, v - far) : nothing,
                                 v + far < camera.height ? point_of(sight, c, u, v + far) : nothing);
  const glm::vec3 normal = glm::cross(across, down);
  if (!(glm::dot(normal, normal) > 1e-16F)) return nothing;
  return glm::normalize(rotated(camera.T_world_camera, glm::dot(normal, at) > 0 ? -normal : normal));
}

SampledContacts sample_contacts(const Touch& touch, const Finger& finger) {
  struct Least {
    std::uint32_t hash, contact;
  };
  std::array<std::optional<Least>, most_samples> least{};
  for (const std::uint32_t i : finger.contacts) {
    const std::uint32_t hash = touch.contacts[i].point * sample_hash;
    std::optional<Least>& bucket = least[hash >> sample_shift];
    if (!bucket || hash < bucket->hash) bucket = {hash, i};
  }
  SampledContacts contacts;
  for (const auto& bucket : least) {
    if (bucket) contacts.push_back(bucket->contact);
  }
  return contacts;
}

SkinSamples sample_skin(const Sight& sight, const Touch& touch, const Finger& finger) {
  SkinSamples samples;
  for (const std::uint32_t place : sample_contacts(touch, finger)) {
    const Contact& contact = touch.contacts[place];
    const glm::vec3 normal = normal_at(sight, contact.point);
    if (glm::dot(normal, normal) > 0) samples.push_back({contact.position, normal});
  }
  return samples;
}

glm::vec3 normal_of(const SkinSamples& samples) {
  glm::vec3 normal{0};
  for (const SkinSample& sample : samples)
    normal += sample.normal;
  return glm::dot(normal, normal) > 0 ? glm::normalize(normal) : glm::vec3(0);
}

glm::vec3 inside_of(const SkinSample& sample, float finger_width) {
  // The inside of a finger lies below its skin by this share of its greatest width.
  return sample.position - sample.normal * (0.36F * finger_width);
}

}  // namespace palpa::touch
