// Where afferents are in the skin of a fingertip.
//
// Sites are centroids of faces, a spacing apart, and each stands for the skin that is nearest to it. At each site are
// all seventeen models. A model stands for the afferents of its class in the site's skin, divided equally among the
// models of the class, so that no afferent's place or model is drawn at random.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "observer/afferents/models.hpp"

namespace palpa::observer {

inline constexpr double fingertip_reach_m = 22e-3, site_spacing_m = 1.6e-3;

struct SkinSites {
  std::vector<std::uint32_t> faces;  ///< of the body, ascending: those whose centroid is within the reach of the tip
  std::vector<Vec3> positions;       ///< of sites, m
  std::vector<double> areas_cm2;     ///< of the skin that a site stands for
};

/// `body` has its tip at the origin. The sites are the first faces, in the order of the mesh, that are farther than the
/// spacing from all earlier sites.
SkinSites sites_of(const geometry::Mesh& body);
/// The site nearest to a place.
std::size_t nearest_site(const SkinSites& sites, const Vec3& place);

/// The number of afferents for which one model stands at a site of this area.
double afferents_at(double area_cm2, AfferentClass kind);

}  // namespace palpa::observer
