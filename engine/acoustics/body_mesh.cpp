#include "acoustics/body_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>

#include "acoustics/surface_operator.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/memory.hpp"
#include "geometry/bvh.hpp"
#include "geometry/self_intersection.hpp"
#include "geometry/surface_depth.hpp"
#include "geometry/text.hpp"
#include "geometry/topology.hpp"

namespace palpa::acoustics {

using geometry::Mesh;

namespace {

constexpr double fine_sides = 6, coarse_sides = 3;  // per wavelength
/// Coordinates beyond have lost what a transducer's wave needs of them.
constexpr double farthest_m = 100;

void check_faces(const std::string& file, const Mesh& mesh) {
  if (mesh.triangles.empty()) throw bad_input(file, "has no faces; a body is a closed surface of triangles");
  for (const Vec3& p : mesh.positions) {
    if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= farthest_m))
      throw bad_input(file, "has a vertex farther than 100 m from the origin; coordinates are metres");
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 area = geometry::area_vector(mesh, t);
    double longest = 0;
    for (int i = 0; i < 3; ++i)
      longest = std::max(
          longest, glm::distance(mesh.positions[mesh.triangles[t][i]], mesh.positions[mesh.triangles[t][(i + 1) % 3]]));
    // A needle a thousand times as long as wide has no normal to speak of.
    if (!(glm::length(area) > 1e-3 * longest * longest)) {
      throw bad_input(file, fmt::format("face {} at {} m is a needle without area; mend the mesh, a remesher such as "
                                        "MeshLab's isotropic one does",
                                        t, geometry::text::point(mesh.positions[mesh.triangles[t][0]])));
    }
  }
}

void check_closed(const std::string& file, const Mesh& mesh) {
  const geometry::Defects defects = geometry::find_defects(mesh);
  const auto refuse = [&](const char* what, std::array<std::uint32_t, 2> edge) {
    throw bad_input(
        file,
        fmt::format("{} between {} and {} m; a body's surface is closed and its faces turn the same way", what,
                    geometry::text::point(mesh.positions[edge[0]]), geometry::text::point(mesh.positions[edge[1]])));
  };
  if (defects.open > 0) refuse("the mesh is open, at its edge", defects.first_open);
  if (defects.non_manifold > 0) refuse("more than two faces meet at the edge", defects.first_non_manifold);
  if (defects.flipped > 0) refuse("faces of opposite orientation meet at the edge", defects.first_flipped);
}

}  // namespace

Mesh body_mesh(const std::string& file, const Mesh& mesh) {
  Mesh body = geometry::weld(mesh);
  check_faces(file, mesh.triangles.size() == body.triangles.size() ? body : mesh);
  check_closed(file, body);
  const double volume = geometry::signed_volume(body), area = geometry::area(body);
  if (!(std::abs(volume) > 1e-6 * area * std::sqrt(area)))
    throw bad_input(file, "encloses no volume; a body is a closed surface");
  const auto crossing =
      geometry::find_self_intersection(body, geometry::Bvh(body), geometry::most_pairs(body.triangles.size()));
  if (crossing) {
    throw bad_input(
        file, fmt::format("passes through or touches itself: faces {} and {} meet near {} m; mend the mesh",
                          crossing->triangles[0], crossing->triangles[1], geometry::text::point(crossing->where)));
  }
  if (volume < 0) {
    log::warning(fmt::format("{}: faces inwards; taken the other way round", file));
    geometry::flip(body);
  }
  return body;
}

double mean_side(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      sum += glm::distance(mesh.positions[t[i]], mesh.positions[t[(i + 1) % 3]]);
  }
  return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

void check_fineness(const std::string& file, const Mesh& body, double wavelength_m, bool force) {
  const double side = mean_side(body);
  if (side <= wavelength_m / fine_sides) return;
  const std::string what = fmt::format("its faces' sides are {:.2f} mm on average, the wavelength is {:.2f} mm",
                                       side * 1e3, wavelength_m * 1e3);
  if (side > wavelength_m / coarse_sides && !force) {
    throw bad_input(file, fmt::format("too coarse: {}; below {:.2f} mm results mean something, --force has them anyway",
                                      what, wavelength_m / coarse_sides * 1e3));
  }
  log::warning(fmt::format("{}: coarse: {}; below {:.2f} mm errors are a few percent or less", file, what,
                           wavelength_m / fine_sides * 1e3));
}

void check_clear_of(const std::string& file, const Mesh& body, const array::Layout& layout) {
  Box box = geometry::bounds(body);
  box.low -= Vec3(layout.transducer_radius_m);
  box.high += Vec3(layout.transducer_radius_m);
  for (std::size_t i = 0; i < layout.transducers.size(); ++i) {
    const Vec3& at = layout.transducers[i].position;
    if (geometry::distance2(box, at) > 0) continue;
    const double depth = geometry::surface_depth(body, at);
    if (depth < -layout.transducer_radius_m) continue;
    throw bad_input(file,
                    fmt::format("stands in the array: transducer {} at {} m is {}; move the body away", i,
                                geometry::text::point(at),
                                depth > 0 ? "inside of it" : fmt::format("{:.2f} mm from its surface", -depth * 1e3)));
  }
}

void check_memory(const Mesh& body) {
  require_memory(dense_operator_bytes(body), fmt::format("a body of {} faces", body.triangles.size()),
                 "give a mesh of fewer faces");
}

Inside::Inside(const Mesh& body) : bounds_(geometry::bounds(body)), surface_(geometry::make_surface(body, {})) {}

bool Inside::holds(const Vec3& point) const {
  if (geometry::distance2(bounds_, point) > 0) return false;  // the surface's grid knows its own box only
  const float reach = static_cast<float>(surface_.options.reach_m);
  return geometry::find_place(surface_, glm::vec3(point - surface_.centre), reach).region != geometry::Region::outside;
}

}  // namespace palpa::acoustics
