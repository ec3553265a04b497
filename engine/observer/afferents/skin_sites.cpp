#include "observer/afferents/skin_sites.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace palpa::observer {

SkinSites sites_of(const geometry::Mesh& body) {
  SkinSites sites;
  std::vector<Vec3> centroids;
  std::vector<double> areas_cm2;
  for (std::uint32_t f = 0; f < body.triangles.size(); ++f) {
    const glm::uvec3& t = body.triangles[f];
    const Vec3 &a = body.positions[t.x], &b = body.positions[t.y], &c = body.positions[t.z];
    const Vec3 centroid = (a + b + c) / 3.0;
    if (glm::length(centroid) > fingertip_reach_m) continue;
    sites.faces.push_back(f);
    centroids.push_back(centroid);
    areas_cm2.push_back(glm::length(glm::cross(b - a, c - a)) / 2 * 1e4);
  }
  for (const Vec3& centroid : centroids) {
    const auto near = [&](const Vec3& site) { return glm::distance(site, centroid) < site_spacing_m; };
    if (std::ranges::none_of(sites.positions, near)) sites.positions.push_back(centroid);
  }
  sites.areas_cm2.resize(sites.positions.size());
  for (std::size_t f = 0; f < centroids.size(); ++f)
    sites.areas_cm2[nearest_site(sites, centroids[f])] += areas_cm2[f];
  return sites;
}

std::size_t nearest_site(const SkinSites& sites, const Vec3& place) {
  const auto nearest =
      std::ranges::min_element(sites.positions, {}, [&](const Vec3& site) { return glm::distance(site, place); });
  return static_cast<std::size_t>(nearest - sites.positions.begin());
}

double afferents_at(double area_cm2, AfferentClass kind) {
  return area_cm2 * density_per_cm2(kind) / static_cast<double>(models_of(kind));
}

}  // namespace palpa::observer
