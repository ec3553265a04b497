#include "geometry/parts/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "base/error.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace palpa::geometry {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// qhull's state, freed in every case. qhull keeps pointers into it, so it never moves.
class Qhull {
 public:
  Qhull() { qh_zero(&state, nullptr); }
  ~Qhull() {
    state.NOerrexit = True;
    qh_freeqhull(&state, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(&state, &blocks, &bytes);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  qhT state;
};

/// A facet in qhull's output: three point numbers, and the plane that it shares with the facet it was cut from.
struct Facet {
  std::array<std::uint32_t, 3> corners;
  Vec3 normal;
};

std::vector<Facet> facets_of(Qhull& hull) {
  qhT* qh = &hull.state;
  std::vector<Facet> facets;
  facetT* facet = nullptr;
  FORALLfacets {
    Facet f{{}, {facet->normal[0], facet->normal[1], facet->normal[2]}};
    int corner = 0;
    vertexT *vertex = nullptr, **vertexp = nullptr;
    FOREACHvertex_(facet->vertices) {
      if (corner < 3)
        f.corners[static_cast<std::size_t>(corner)] = static_cast<std::uint32_t>(qh_pointid(qh, vertex->point));
      ++corner;
    }
    if (corner != 3) return {};
    // The order is topological, not geometric, so it is correct even for triangles without area.
    if (facet->toporient) std::swap(f.corners[1], f.corners[2]);
    facets.push_back(f);
  }
  return facets;
}

/// Vertices in the order of the input, triangles in an order that depends only on their vertices.
Hull in_order(std::span<const Vec3> points, std::vector<Facet> facets) {
  for (Facet& f : facets)
    std::rotate(f.corners.begin(), std::min_element(f.corners.begin(), f.corners.end()), f.corners.end());
  std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) { return a.corners < b.corners; });
  constexpr std::uint32_t unused = 0xffffffffU;
  std::vector<std::uint32_t> place(points.size(), unused);
  for (const Facet& f : facets) {
    for (const std::uint32_t corner : f.corners)
      place[corner] = 0;
  }
  Hull hull;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (place[i] == unused) continue;
    place[i] = static_cast<std::uint32_t>(hull.mesh.positions.size());
    hull.mesh.positions.push_back(points[i]);
  }
  std::map<std::array<double, 3>, std::uint32_t> plane_of;
  for (const Facet& f : facets) {
    hull.mesh.triangles.emplace_back(place[f.corners[0]], place[f.corners[1]], place[f.corners[2]]);
    const auto [known, fresh] =
        plane_of.try_emplace({f.normal.x, f.normal.y, f.normal.z}, static_cast<std::uint32_t>(hull.planes.size()));
    hull.plane_of_triangle.push_back(known->second);
    if (fresh) hull.planes.push_back({f.normal, 0});
  }
  if (signed_volume(hull.mesh) < 0) flip(hull.mesh);
  for (Plane& plane : hull.planes) {
    plane.offset = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : points)
      plane.offset = std::max(plane.offset, glm::dot(plane.normal, p));
  }
  return hull;
}

}  // namespace

std::optional<Hull> convex_hull(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) {
    if (!is_finite(p)) throw failure("a point of a convex hull is not finite");
    box.add(p);
  }
  if (points.size() < 4) return std::nullopt;
  // Relative to the centre, so that rounding depends on the cloud's own size.
  const Vec3 centre = box.centre();
  std::vector<coordT> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis)
      coordinates.push_back(p[axis] - centre[axis]);
  }
  const std::unique_ptr<std::FILE, CloseFile> nowhere(std::fopen("/dev/null", "w"));
  Qhull hull;
  std::string command = "qhull Qt";  // merged facets, cut into triangles that share their plane
  const int fault = qh_new_qhull(&hull.state, 3, static_cast<int>(points.size()), coordinates.data(), False,
                                 command.data(), nullptr, nowhere ? nowhere.get() : stderr);
  if (fault != 0) return std::nullopt;  // flat, possibly up to rounding
  std::vector<Facet> facets = facets_of(hull);
  if (facets.size() < 4) return std::nullopt;
  Hull result = in_order(points, std::move(facets));
  const Vec3 extent = box.high - box.low;
  const double size = std::max({extent.x, extent.y, extent.z});
  if (!(signed_volume(result.mesh) > 1e-9 * size * size * size) || !find_defects(result.mesh).closed_and_oriented())
    return std::nullopt;
  return result;
}

}  // namespace palpa::geometry
