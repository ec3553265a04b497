#include "geometry/parts/parts.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "geometry/parts/convex_hull.hpp"

namespace palpa::geometry {

std::optional<Part> make_part(std::span<const Vec3> points) {
  std::vector<Vec3> rounded;
  rounded.reserve(points.size());
  for (const Vec3& p : points)
    rounded.emplace_back(glm::vec3(p) + glm::vec3(0));  // + 0 makes a negative zero positive
  std::optional<Hull> hull = convex_hull(rounded);
  if (!hull) return std::nullopt;
  Part part{std::move(hull->mesh), std::move(hull->planes), std::move(hull->plane_of_triangle), {}};
  part.bounds = bounds(part.mesh);
  return part;
}

double smallest_seam(std::span<const Part> parts) {
  Box all;
  for (const Part& part : parts) {
    all.add(part.bounds.low);
    all.add(part.bounds.high);
  }
  return flatness_tolerance(all);
}

double depth(const Part& part, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : part.planes)
    least = std::min(least, plane.offset - glm::dot(plane.normal, point));
  return least;
}

double depth(const Parts& parts, InternalFaces faces, const Vec3& point) {
  if (faces == InternalFaces::drop) return depth(parts, union_surface(parts), point);
  double least = std::numeric_limits<double>::infinity();
  for (const Part& part : parts.parts) {
    const double here = depth(part, point);
    if (here > 0) least = std::min(least, here);
  }
  return std::isfinite(least) ? least : 0;
}

}  // namespace palpa::geometry
