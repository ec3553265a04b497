#include "acoustics/bodies/body_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "acoustics/compressed/body_operator.hpp"
#include "acoustics/elements/patches.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/memory.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/nearest.hpp"
#include "geometry/mesh/self_intersection.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/surface/surface_depth.hpp"
#include "geometry/text.hpp"

namespace palpa::acoustics {

using geometry::Mesh;

namespace {

constexpr double fine_sides = 6, fine_long_sides = 5.5, coarse_sides = 3;  // per wavelength
constexpr double least_bend = 12 * std::numbers::pi / 180;
/// In sides between a source and the mesh. The error of a sphere's pressure is twice that of a distant source at two
/// sides, and 10 to 20 % at half a side.
constexpr double fine_source = 2, coarse_source = 0.5;
/// A face this many times as long as high is a needle.
constexpr double needle = 10;
/// Farther coordinates are too imprecise for a transducer's wave.
constexpr double farthest_m = 100;
/// Smaller pieces of a body have faces that single precision cannot distinguish.
constexpr double smallest_m = 1e-6;
/// The matrix is in single precision. The points of two faces may coincide there if the faces are shorter than this
/// part of the body, and the square of a face's area may underflow if the face is lower than this.
constexpr double shortest_part = 1e-7, lowest_m = 1e-9;

double length_by_height(const Mesh& mesh, std::uint32_t face) {
  return longest_side(mesh, face) / triangle_width(mesh, face);
}

double largest_extent(const Box& box) {
  const Vec3 extent = box.high - box.low;
  return std::max({extent.x, extent.y, extent.z});
}

/// `what` says whether this is the box of the whole body or of a piece.
void check_size(const std::string& file, const char* what, const Box& box) {
  const double size = largest_extent(box);
  if (size >= smallest_m) return;
  throw bad_input(file, fmt::format("{} only {:.4g} m across, near {} m; a body measures at least a micrometre, and "
                                    "coordinates are metres",
                                    what, size, geometry::text::point(box.low)));
}

void check_faces(const std::string& file, const Mesh& mesh) {
  if (mesh.triangles.empty()) throw bad_input(file, "has no faces; a body is a closed surface of triangles");
  for (const Vec3& p : mesh.positions) {
    if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= farthest_m))
      throw bad_input(file, "has a vertex farther than 100 m from the origin; coordinates are metres");
  }
  check_size(file, "is", geometry::bounds(mesh));  // first, because smaller bodies may have areas of zero
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    // A thousand times as long as high, it has no meaningful normal.
    if (!(length_by_height(mesh, t) < 1e3)) {
      throw bad_input(file, fmt::format("face {} at {} m is a needle without area; mend the mesh, for example with a "
                                        "remesher such as MeshLab's isotropic one",
                                        t, geometry::text::point(mesh.positions[mesh.triangles[t][0]])));
    }
  }
}

void check_closed(const std::string& file, const Mesh& mesh) {
  const geometry::Defects defects = geometry::find_defects(mesh);
  const auto refuse = [&](const char* what, std::array<std::uint32_t, 2> edge) {
    throw bad_input(
        file,
        fmt::format("{} between {} and {} m; a body's surface must be closed and consistently oriented", what,
                    geometry::text::point(mesh.positions[edge[0]]), geometry::text::point(mesh.positions[edge[1]])));
  };
  if (defects.open > 0) refuse("the mesh is open, at its edge", defects.first_open);
  if (defects.non_manifold > 0) refuse("more than two faces meet at the edge", defects.first_non_manifold);
  if (defects.flipped > 0) refuse("faces of opposite orientation meet at the edge", defects.first_flipped);
}

/// Checks that no piece is too small.
void check_sizes(const std::string& file, const Mesh& body, const geometry::Shells& shells) {
  std::vector<Box> boxes(shells.list.size());
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i)
      boxes[shells.of_triangle[t]].add(body.positions[body.triangles[t][i]]);
  }
  for (const Box& box : boxes)
    check_size(file, "has a piece that is", box);
}

/// Checks that no face is too small for the matrix.
void check_face_sizes(const std::string& file, const Mesh& body) {
  const double body_m = largest_extent(geometry::bounds(body));
  const double shortest_m = std::max(lowest_m, shortest_part * body_m);
  for (std::uint32_t t = 0; t < body.triangles.size(); ++t) {
    if (longest_side(body, t) >= shortest_m && triangle_width(body, t) >= lowest_m) continue;
    throw bad_input(
        file, fmt::format("face {} at {} m is only {:.2g} m long and {:.2g} m high; a face of a body of {:.2g} m is at "
                          "least {:.2g} m long and a nanometre high; remove such faces, for example with a remesher "
                          "such as MeshLab's isotropic one",
                          t, geometry::text::point(body.positions[body.triangles[t][0]]), longest_side(body, t),
                          triangle_width(body, t), body_m, shortest_m));
  }
}

/// Checks that no piece lies within another.
void check_apart(const std::string& file, const Mesh& body, const geometry::Bvh& tree, geometry::Shells& shells) {
  geometry::find_nesting(body, tree, shells);
  for (const geometry::Shell& shell : shells.list) {
    if (shell.depth == 0) continue;
    throw bad_input(
        file, fmt::format(
                  "has a piece within another, or a cavity, near {} m, which no sound reaches; remove the inner piece",
                  geometry::text::point(body.positions[body.triangles[shell.first][0]])));
  }
}

void turn_outwards(const std::string& file, Mesh& body, const geometry::Shells& shells) {
  std::vector<char> inwards;
  for (const geometry::Shell& shell : shells.list)
    inwards.push_back(shell.volume < 0 ? 1 : 0);
  const auto count = std::ranges::count(inwards, 1);
  if (count == 0) return;
  log::warning(shells.list.size() == 1 ? fmt::format("{}: its faces point inwards; palpa turns them", file)
                                       : fmt::format("{}: {} of its {} pieces face inwards; palpa turns them", file,
                                                     count, shells.list.size()));
  geometry::flip(body, shells, inwards);
}

}  // namespace

Mesh body_mesh(const std::string& file, const Mesh& mesh) {
  Activity activity("checking " + file);
  Mesh body = geometry::weld(mesh);
  check_faces(file, mesh.triangles.size() == body.triangles.size() ? body : mesh);
  check_closed(file, body);
  geometry::Shells shells = geometry::find_shells(body, geometry::twins(body));
  check_sizes(file, body, shells);
  check_face_sizes(file, body);
  for (const geometry::Shell& shell : shells.list) {
    if (!(std::abs(shell.volume) > 1e-6 * shell.area * std::sqrt(shell.area)))
      throw bad_input(file, "encloses no volume; a body is a closed surface");
  }
  const geometry::Bvh tree(body);
  if (const auto crossing = geometry::find_self_intersection(body, tree, geometry::most_pairs(body.triangles.size()))) {
    throw bad_input(
        file, fmt::format("passes through or touches itself: faces {} and {} meet near {} m; mend the mesh",
                          crossing->triangles[0], crossing->triangles[1], geometry::text::point(crossing->where)));
  }
  if (shells.list.size() > 1) check_apart(file, body, tree, shells);
  turn_outwards(file, body, shells);
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

double long_side(const Mesh& mesh) {
  std::vector<double> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      sides.push_back(glm::distance(mesh.positions[t[i]], mesh.positions[t[(i + 1) % 3]]));
  }
  const auto at = static_cast<std::ptrdiff_t>(sides.size() * 95 / 100);
  std::ranges::nth_element(sides, sides.begin() + at);
  return sides[static_cast<std::size_t>(at)];
}

double mean_bend(const Mesh& body) {
  const std::vector<std::uint32_t> twin = geometry::twins(body);
  std::vector<Vec3> areas;
  for (std::uint32_t face = 0; face < body.triangles.size(); ++face)
    areas.push_back(geometry::area_vector(body, face));
  double sum = 0, weights = 0;
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    const Vec3 &a = areas[side / 3], &b = areas[twin[side] / 3];
    const double bend = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    if (bend > sharp_turn) continue;
    const double weight = glm::length(a) + glm::length(b);
    sum += weight * bend * bend;
    weights += weight;
  }
  return weights > 0 ? std::sqrt(sum / weights) : 0;
}

void warn_of_bends(const std::string& file, const Mesh& body) {
  const double bend = mean_bend(body);
  if (bend <= least_bend) return;
  constexpr double degree = std::numbers::pi / 180;
  log::warning(fmt::format(
      "{}: angular: neighbouring faces bend by {:.0f} degrees on average; up to {:.0f} degrees, the radiation pressure "
      "of each face is within 2 %",
      file, bend / degree, least_bend / degree));
}

/// The longest side of a likely body; longer ones are probably in millimetres.
constexpr double unlikely_side_m = 0.1;

void check_fineness(const std::string& file, const Mesh& body, double wavelength_m, bool force) {
  const double side = mean_side(body), longest = long_side(body);
  if (side <= wavelength_m / fine_sides && longest <= wavelength_m / fine_long_sides) return;
  if (side <= wavelength_m / fine_sides) {
    log::warning(
        fmt::format("{}: uneven: a twentieth of its faces' sides are longer than {:.2f} mm, the wavelength is {:.2f} "
                    "mm; if they are below {:.2f} mm, errors are a few percent or less",
                    file, longest * 1e3, wavelength_m * 1e3, wavelength_m / fine_long_sides * 1e3));
    return;
  }
  const std::string what = fmt::format("its faces' sides are {:.2f} mm on average, the wavelength is {:.2f} mm",
                                       side * 1e3, wavelength_m * 1e3);
  if (side > wavelength_m / coarse_sides && !force) {
    throw bad_input(
        file, fmt::format("too coarse: {}; below {:.2f} mm, results are meaningful; {}--force computes them anyway",
                          what, wavelength_m / coarse_sides * 1e3,
                          side > unlikely_side_m ? "see whether its vertices are in metres; " : ""));
  }
  log::warning(fmt::format("{}: coarse: {}; below {:.2f} mm, errors are a few percent or less", file, what,
                           wavelength_m / fine_sides * 1e3));
}

void warn_of_needles(const std::string& file, const Mesh& body) {
  std::size_t count = 0;
  std::uint32_t worst = 0;
  double most = 0;
  for (std::uint32_t t = 0; t < body.triangles.size(); ++t) {
    const double times = length_by_height(body, t);
    count += times > needle ? 1 : 0;
    if (times <= most) continue;
    most = times;
    worst = t;
  }
  if (count == 0) return;
  log::warning(
      fmt::format("{}: {} of its {} faces are needles, more than {} times as long as high (face {} at {} m: {:.0f} "
                  "times); they take longer and are less exact; a remesher such as MeshLab's isotropic one mends them",
                  file, count, body.triangles.size(), needle, worst,
                  geometry::text::point(body.positions[body.triangles[worst].x]), most));
}

void check_source(const Mesh& body, const Vec3& source, bool force) {
  const geometry::NearestTriangle::Found found = geometry::NearestTriangle(body).find(source).value();
  if (Inside(body).holds(source)) {
    throw bad_usage(fmt::format("--point-source: {} m lies inside the mesh; give a point in the air",
                                geometry::text::point(source)));
  }
  const double side = mean_side({body.positions, {body.triangles[found.triangle]}});
  if (found.distance >= fine_source * side) return;
  const std::string what =
      fmt::format("--point-source: {:.2f} mm from the mesh, whose faces there have sides of {:.2f} mm",
                  found.distance * 1e3, side * 1e3);
  if (found.distance < coarse_source * side && !force)
    throw bad_usage(what +
                    "; move it away by at least half a side, or make the mesh finer; --force computes it anyway");
  log::warning(what + "; nearer than two sides, results are less exact");
}

namespace {

/// A wall of transducers extends this far beyond them, in distances between neighbours: boards leave some places empty.
constexpr double wall_margin = 1.2;

/// Whether a corner of the box lies behind one of the transducers.
bool may_be_behind(const Box& box, const array::Layout& layout) {
  return std::ranges::any_of(layout.transducers, [&](const array::Transducer& t) {
    // The corner of the box that lies farthest back along the axis.
    const Vec3 corner(t.axis.x > 0 ? box.low.x : box.high.x, t.axis.y > 0 ? box.low.y : box.high.y,
                      t.axis.z > 0 ? box.low.z : box.high.z);
    return glm::dot(corner - t.position, t.axis) < 0;
  });
}

std::size_t nearest_transducer(const array::Layout& layout, const Vec3& point, std::optional<std::size_t> but = {}) {
  std::size_t best = layout.transducers.size();
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < layout.transducers.size(); ++i) {
    const Vec3 way = layout.transducers[i].position - point;
    if (i == but || glm::dot(way, way) >= best2) continue;
    best2 = glm::dot(way, way);
    best = i;
  }
  return best;
}

/// Neighbouring transducers form a wall; the body must stay on their sounding side.
void check_before_wall(const std::string& file, const Mesh& body, const array::Layout& layout) {
  if (layout.transducers.size() < 2 || !may_be_behind(geometry::bounds(body), layout)) return;
  std::vector<std::size_t> behind(body.positions.size(), layout.transducers.size());
  parallel_chunks(body.positions.size(), 64, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t near = nearest_transducer(layout, body.positions[v]);
      const array::Transducer& t = layout.transducers[near];
      const Vec3 way = body.positions[v] - t.position;
      const double ahead = glm::dot(way, t.axis);
      if (ahead >= 0) continue;
      const double pitch =
          glm::distance(t.position, layout.transducers[nearest_transducer(layout, t.position, near)].position);
      if (glm::length(way - ahead * t.axis) < wall_margin * pitch) behind[v] = near;
    }
  });
  for (std::size_t v = 0; v < behind.size(); ++v) {
    if (behind[v] == layout.transducers.size()) continue;
    throw bad_input(file, fmt::format("stands in the array: {} m is behind its wall, beside transducer {} at {} m; "
                                      "move the body away",
                                      geometry::text::point(body.positions[v]), behind[v],
                                      geometry::text::point(layout.transducers[behind[v]].position)));
  }
}

}  // namespace

void check_clear_of(const std::string& file, const Mesh& body, const array::Layout& layout) {
  Box box = geometry::bounds(body);
  box.low -= Vec3(layout.transducer_radius_m);
  box.high += Vec3(layout.transducer_radius_m);
  for (std::size_t i = 0; i < layout.transducers.size(); ++i) {
    const Vec3& at = layout.transducers[i].position;
    if (geometry::distance2(box, at) > 0) continue;
    const double depth = geometry::surface_depth(body, at);
    if (depth < -layout.transducer_radius_m) continue;
    throw bad_input(
        file, fmt::format(
                  "stands in the array: transducer {} at {} m is {}; move the body away", i, geometry::text::point(at),
                  depth > 0 ? "inside the body" : fmt::format("{:.2f} mm from the body's surface", -depth * 1e3)));
  }
  check_before_wall(file, body, layout);
}

void check_memory(const Mesh& body, double wave_number) {
  // The polynomial of a face: about 27 vertices with 21 numbers each (surface_sound.hpp).
  constexpr std::uint64_t fit_bytes = 2600;
  require_memory(operator_bytes(body, wave_number) + fit_bytes * body.triangles.size(),
                 fmt::format("a body of {} faces", body.triangles.size()), "give a mesh of fewer faces");
}

Inside::Inside(const Mesh& body) : bounds_(geometry::bounds(body)), surface_(geometry::make_surface(body, {})) {}

bool Inside::holds(const Vec3& point) const {
  if (geometry::distance2(bounds_, point) > 0) return false;  // the surface's grid only covers its own box
  const float reach = static_cast<float>(surface_.options.reach_m);
  return geometry::find_place(surface_, glm::vec3(point - surface_.centre), reach).region != geometry::Region::outside;
}

}  // namespace palpa::acoustics
