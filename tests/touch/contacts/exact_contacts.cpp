#include "touch/contacts/exact_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::touch::test {

ExactDepth::ExactDepth(const geometry::Solid& solid) : solid_(&solid) {
  if (!solid.parts.parts.empty()) surface_ = geometry::union_surface(solid.parts);
}

double ExactDepth::operator()(const Vec3& point) const {
  if (!solid_->parts.parts.empty() && solid_->internal_faces == geometry::InternalFaces::drop)
    return geometry::depth(solid_->parts, surface_, point);
  const auto below = [&](const std::vector<geometry::Plane>& planes) {
    double depth = 1e300;
    for (const geometry::Plane& plane : planes)
      depth = std::min(depth, plane.offset - glm::dot(plane.normal, point));
    return depth;
  };
  if (solid_->parts.parts.empty()) return below(solid_->planes);
  double least = 1e300;
  for (const geometry::Part& part : solid_->parts.parts) {
    if (const double depth = below(part.planes); depth > 0) least = std::min(least, depth);
  }
  return least < 1e300 ? least : 0;
}

std::size_t expect_contacts(const Touch& touch, const std::vector<glm::vec3>& points,
                            const std::vector<geometry::Solid>& solids, double delta) {
  EXPECT_TRUE(std::ranges::is_sorted(touch.contacts, {}, &Contact::point));
  std::vector<const Contact*> contact_of(points.size(), nullptr);
  for (const Contact& contact : touch.contacts) {
    EXPECT_EQ(contact.position, points.at(contact.point));
    contact_of[contact.point] = &contact;
  }
  const std::vector<ExactDepth> exact(solids.begin(), solids.end());
  std::size_t undecided = 0, contacts = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p(points[i]);
    std::uint32_t solid = 0;
    bool close = false, in_shell = false;
    double depth = 0;
    for (; solid < solids.size(); ++solid) {
      const double own = solids[solid].haptics.delta_m.value_or(delta);
      depth = exact[solid](p);
      const std::vector<geometry::Part>& parts = solids[solid].parts.parts;
      close = close || std::abs(depth - own) < band || (parts.empty() && std::abs(depth) < band);
      for (const geometry::Part& part : parts)
        close = close || std::abs(geometry::depth(part, p)) < band;
      in_shell = depth > 0 && depth < own;
      if (in_shell) break;
    }
    if (close) {
      ++undecided;
      continue;
    }
    EXPECT_EQ(contact_of[i] != nullptr, in_shell) << "point " << i << " depth " << depth;
    if (!in_shell || contact_of[i] == nullptr) continue;
    ++contacts;
    EXPECT_EQ(contact_of[i]->solid, solid) << "point " << i;
    EXPECT_NEAR(contact_of[i]->depth_m, depth, band) << "point " << i;
  }
  EXPECT_LE(undecided, points.size() / 100 + 10);
  return contacts;
}

}  // namespace palpa::touch::test
