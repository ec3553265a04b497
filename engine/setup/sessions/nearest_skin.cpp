#include "setup/sessions/nearest_skin.hpp"

#include <fmt/core.h>

#include <limits>
#include <vector>

#include "geometry/mesh/nearest.hpp"
#include "sensing/skin_twin.hpp"

namespace palpa::setup {
namespace {

/// A box around everything that the cameras can see.
Box seen_by(std::span<const sensing::Camera> cameras) {
  Box box;
  for (const sensing::Camera& camera : cameras) {
    const Vec3 eye(camera.T_world_camera[3]);
    const Vec3 farthest(4 * camera.depth_unit_m * std::numeric_limits<std::uint16_t>::max());
    box.add(eye - farthest);
    box.add(eye + farthest);
  }
  return box;
}

}  // namespace

std::optional<NearestSkin> nearest_skin(std::span<const geometry::Solid> solids, const TouchInput& input) {
  const std::vector<sensing::SkinPoint> skin =
      input.cameras.empty() ? input.points : sensing::find_skin(input.cameras, input.frames, seen_by(input.cameras));
  std::optional<NearestSkin> nearest;
  Vec3 at(0);
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const geometry::NearestTriangle surface(solids[s].mesh);
    for (const sensing::SkinPoint& point : skin) {
      const Vec3 p(point.position);
      const double most = nearest ? nearest->distance_m : std::numeric_limits<double>::infinity();
      const double distance = surface.distance(p, most);
      if (distance >= most) continue;
      nearest = {distance, s, false};
      at = p;
    }
  }
  if (nearest) nearest->inside = geometry::depth(solids[nearest->solid], at) > 0;
  return nearest;
}

std::string place_of(const NearestSkin& nearest, const std::string& solid) {
  if (nearest.distance_m < 0.05e-3) return fmt::format("on the surface of {}, not below it", solid);
  constexpr double far_m = 1;  // of skin from a file
  return fmt::format("{:.1f} mm {} the surface of {}{}{}", nearest.distance_m * 1e3,
                     nearest.inside ? "below" : "away from", solid, nearest.inside ? ", deeper than its shell" : "",
                     nearest.distance_m > far_m ? " (coordinates are metres)" : "");
}

std::string place_of(const NearestSkin& nearest, std::span<const geometry::Solid> solids) {
  return place_of(nearest, solids[nearest.solid].name);
}

}  // namespace palpa::setup
