#include "touch/fingers/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>

#include "sensing/surroundings.hpp"

namespace palpa::touch {
namespace {

/// Pixels to either side that give the skin's normal.
constexpr std::uint32_t normal_pixels = 2;
/// The upper bits of a hash sort contacts into most_samples buckets; each bucket keeps the contact with the least hash.
/// The hash is invertible: contact = hash * unhash, modulo 2^32.
constexpr std::uint32_t sample_shift = 26;
constexpr std::uint32_t sample_hash = 0x9e3779b1;
constexpr std::uint32_t sample_unhash = 0x0e8b2f51;
static_assert(most_samples == 1U << (32 - sample_shift));

Float3 rotated(const shader::vec4& x, const shader::vec4& y, const shader::vec4& z, const Float3& v) {
  Float3 r;
  r.x = x.x * v.x + x.y * v.y + x.z * v.z;
  r.y = y.x * v.x + y.y * v.y + y.z * v.z;
  r.z = z.x * v.x + z.y * v.y + z.z * v.z;
  return r;
}

/// A pixel's point in camera coordinates. The depth is 0 if there is no data or no ray, or if the camera ignores the
/// pixel.
Float3 point_of(const Sight& sight, std::size_t c, std::uint32_t u, std::uint32_t v) {
  const SightCamera& camera = sight.cameras[c];
  const glm::vec2& ray = sight.tables.rays[camera.first_pixel + std::size_t{v} * camera.pitch + u];
  const std::uint32_t raw = raw_at(sight, c, u, v);
  Float3 p;
  p.z = raw >= camera.first_depth && ray.x != sensing::no_ray ? static_cast<float>(raw) * camera.depth_unit : 0.0F;
  p.x = ray.x * p.z;
  p.y = ray.y * p.z;
  return p;
}

bool same_surface(const Float3& a, const Float3& b) {
  float step = a.z - b.z;
  return b.z > 0.0F && std::abs(step) <= surface_step_m();
}

/// From one neighbour to the other if both are on the surface, else between one of them and the pixel; 0 if neither is.
Float3 tangent(const Float3& at, const Float3& before, const Float3& after) {
  const bool has_before = same_surface(at, before);
  const bool has_after = same_surface(at, after);
  Float3 from = at;
  Float3 to = at;
  if (has_before) from = before;
  if (has_after) to = after;
  return minus(to, from);
}

}  // namespace

std::vector<SightCamera> sight_cameras(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables) {
  std::vector<SightCamera> out;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const sensing::Camera& camera = cameras[i];
    const sensing::CameraTable& table = tables.cameras[i];
    const Transform& pose = camera.T_world_camera;
    const Transform view = glm::inverse(pose);
    const auto single = [](double value) { return static_cast<float>(value); };
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    out.push_back({.pose_x = sensing::row_of(pose, 0),
                   .pose_y = sensing::row_of(pose, 1),
                   .pose_z = sensing::row_of(pose, 2),
                   .view_x = sensing::row_of(view, 0),
                   .view_y = sensing::row_of(view, 1),
                   .view_z = sensing::row_of(view, 2),
                   .lens = {single(camera.fx), single(camera.fy), single(camera.cx), single(camera.cy)},
                   .distortion = {single(k1), single(k2), single(p1), single(p2)},
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

Float3 seen_from(const SightCamera& camera, const Float3& world) {
  const Float3 r = rotated(camera.view_x, camera.view_y, camera.view_z, world);
  Float3 p;
  p.x = r.x + camera.view_x.w;
  p.y = r.y + camera.view_y.w;
  p.z = r.z + camera.view_z.w;
  return p;
}

Appearance appearance(const SightCamera& camera, const Float3& world) {
  const Float3 p = seen_from(camera, world);
  Appearance a;
  a.u = 0U;
  a.v = 0U;
  a.depth = 0.0F;
  if (!(p.z > 1e-3F)) return a;
  float x = p.x / p.z;
  float y = p.y / p.z;
  float r2 = x * x + y * y;
  if (!(r2 <= camera.reach)) return a;
  float radial = 1.0F + r2 * (camera.distortion.x + r2 * (camera.distortion.y + r2 * camera.k3));
  float xd = x * radial + 2.0F * camera.distortion.z * x * y + camera.distortion.w * (r2 + 2.0F * x * x);
  float yd = y * radial + camera.distortion.z * (r2 + 2.0F * y * y) + 2.0F * camera.distortion.w * x * y;
  float u = std::floor(camera.lens.x * xd + camera.lens.z + 0.5F);
  float v = std::floor(camera.lens.y * yd + camera.lens.w + 0.5F);
  if (!(u >= 0.0F && v >= 0.0F && u < float(camera.width) && v < float(camera.height))) return a;
  a.u = std::uint32_t(u);
  a.v = std::uint32_t(v);
  a.depth = p.z;
  return a;
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

Float3 normal_at(const Sight& sight, std::uint32_t point) {
  const auto [c, u, v] = pixel_of(sight, point);
  const SightCamera& camera = sight.cameras[c];
  constexpr std::uint32_t far = normal_pixels;
  const Float3 nothing{0, 0, 0};
  const Float3 at = point_of(sight, c, u, v);
  const Float3 across = tangent(at, u >= far ? point_of(sight, c, u - far, v) : nothing,
                                u + far < camera.width ? point_of(sight, c, u + far, v) : nothing);
  const Float3 down = tangent(at, v >= far ? point_of(sight, c, u, v - far) : nothing,
                              v + far < camera.height ? point_of(sight, c, u, v + far) : nothing);
  Float3 normal = cross3(across, down);
  if (!(dot3(normal, normal) > 1e-16F)) return nothing;
  if (dot3(normal, at) > 0.0F) normal = scaled(normal, -1.0F);
  return unit(rotated(camera.pose_x, camera.pose_y, camera.pose_z, normal));
}

SampledContacts sample_contacts(const Finger& finger) {
  constexpr std::uint32_t none = 0xffffffffU;
  std::array<std::uint32_t, most_samples> least{};
  least.fill(none);
  for (const std::uint32_t i : finger.contacts) {
    const std::uint32_t hash = i * sample_hash;
    std::uint32_t& slot = least[hash >> sample_shift];
    slot = std::min(slot, hash);
  }
  SampledContacts contacts;
  for (const std::uint32_t hash : least) {
    if (hash != none) contacts.push_back(hash * sample_unhash);
  }
  return contacts;
}

SkinSamples sample_skin(const Sight& sight, const Touch& touch, const Finger& finger) {
  SkinSamples samples;
  for (const std::uint32_t place : sample_contacts(finger)) {
    const Contact& contact = touch.contacts[place];
    const Float3 normal = normal_at(sight, contact.point);
    if (dot3(normal, normal) > 0) samples.push_back({float3(contact.position), normal});
  }
  return samples;
}

Float3 inside_of(const SkinSample& sample, float finger_width) {
  // The inside of a finger lies below its skin by this share of its greatest width.
  return minus(sample.position, scaled(sample.normal, 0.36F * finger_width));
}

}  // namespace palpa::touch
