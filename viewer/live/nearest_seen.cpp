#include "viewer/live/nearest_seen.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

#include "setup/sessions/nearest_skin.hpp"

namespace palpa::viewer {
namespace {

/// Whether the point lies behind the triangle that is nearest to it.
bool is_behind(const geometry::Mesh& mesh, const geometry::NearestTriangle::Found& found, const Vec3& point) {
  const auto& triangle = mesh.triangles[found.triangle];
  const auto corner = [&](int i) { return mesh.positions[triangle[i]]; };
  return glm::dot(point - found.point, glm::cross(corner(1) - corner(0), corner(2) - corner(0))) < 0;
}

}  // namespace

NearestSeen::NearestSeen(std::span<const SurfaceMark> solids) : solids_(solids) {
  trees_.reserve(solids.size());
  for (const SurfaceMark& solid : solids)
    trees_.emplace_back(solid.mesh);
}

std::string NearestSeen::tell(std::span<const sensing::SkinPoint> points, std::span<const Transform> poses) const {
  constexpr std::size_t most = 4096;
  const std::size_t step = 1 + points.size() / most;
  std::optional<setup::NearestSkin> nearest;
  for (std::size_t s = 0; s < solids_.size(); ++s) {
    const std::uint32_t solid = solids_[s].solid;
    const Transform T_rest_world = solid < poses.size() ? glm::inverse(poses[solid]) : Transform(1.0);
    for (std::size_t i = 0; i < points.size(); i += step) {
      const Vec3 at = transform_point(T_rest_world, Vec3(points[i].position));
      const auto found = trees_[s].find(at, nearest ? nearest->distance_m : std::numeric_limits<double>::infinity());
      if (found) nearest = {found->distance, s, is_behind(solids_[s].mesh, *found, at)};
    }
  }
  if (nearest) return "the nearest skin is " + setup::place_of(*nearest, solids_[nearest->solid].name);
  return fmt::format("no skin is within {:.0f} mm of the objects", shown_skin_m * 1e3);
}

}  // namespace palpa::viewer
