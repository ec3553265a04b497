#include "touch/fingers/sight.hpp"

#include <algorithm>
#include <array>

#include "touch/fingers/bridge_math.hpp"

namespace palpa::touch {
namespace {

Float3 point_of(const Sight& sight, std::size_t c, std::uint32_t u, std::uint32_t v) {
  const BridgeCamera& camera = sight.cameras[c];
  const glm::vec2& ray = sight.tables.rays[camera.first_pixel + std::size_t{v} * camera.pitch + u];
  return pixel_point(camera, raw_at(sight, c, u, v), {ray.x, ray.y});
}

}  // namespace

std::uint32_t raw_at(const Sight& sight, std::size_t camera, std::uint32_t u, std::uint32_t v) {
  return sight.images[camera].depth[std::size_t{v} * sight.cameras[camera].width + u];
}

SeenPixel pixel_of(const Sight& sight, std::uint32_t point) {
  std::size_t c = 0;
  while (c + 1 < sight.cameras.size() && point >= sight.cameras[c + 1].first_index)
    ++c;
  const BridgeCamera& camera = sight.cameras[c];
  const std::uint32_t pixel = point - camera.first_index;
  return {c, pixel % camera.width, pixel / camera.width};
}

Float3 normal_at(const Sight& sight, std::uint32_t point) {
  const auto [c, u, v] = pixel_of(sight, point);
  const BridgeCamera& camera = sight.cameras[c];
  constexpr std::uint32_t far = bridge_normal_pixels;
  const Float3 nothing{0, 0, 0};
  return skin_normal(camera, point_of(sight, c, u, v), u >= far ? point_of(sight, c, u - far, v) : nothing,
                     u + far < camera.width ? point_of(sight, c, u + far, v) : nothing,
                     v >= far ? point_of(sight, c, u, v - far) : nothing,
                     v + far < camera.height ? point_of(sight, c, u, v + far) : nothing);
}

SampledContacts sample_contacts(const Finger& finger) {
  constexpr std::uint32_t none = 0xffffffffU;
  std::array<std::uint32_t, bridge_samples> least{};
  least.fill(none);
  for (const std::uint32_t i : finger.contacts) {
    const std::uint32_t hash = i * bridge_hash;
    std::uint32_t& slot = least[hash >> bridge_sample_shift];
    slot = std::min(slot, hash);
  }
  SampledContacts contacts;
  for (const std::uint32_t hash : least) {
    if (hash != none) contacts.push_back(hash * bridge_unhash);
  }
  return contacts;
}

SkinSamples sample_skin(const Sight& sight, const Touch& touch, const Finger& finger) {
  SkinSamples samples;
  for (const std::uint32_t place : sample_contacts(finger)) {
    const Contact& contact = touch.contacts[place];
    const glm::vec3& p = contact.position;
    const Float3 normal = normal_at(sight, contact.point);
    if (dot3(normal, normal) > 0) samples.push_back({{p.x, p.y, p.z}, normal});
  }
  return samples;
}

}  // namespace palpa::touch
