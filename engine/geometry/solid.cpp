#include "geometry/solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/surface_depth.hpp"
#include "geometry/text.hpp"
#include "geometry/topology.hpp"

namespace palpa::geometry {
namespace {

constexpr double largest_size = 1e3, smallest_size = 1e-6;  // metres

struct Candidate {
  std::string name;
  Mesh mesh;  // welded
  Haptics haptics;
};

std::string edge_text(const Mesh& mesh, std::array<std::uint32_t, 2> edge) {
  return fmt::format("from {} to {} m", text::point(mesh.positions[edge[0]]), text::point(mesh.positions[edge[1]]));
}

// Exact first; with tolerance only where that does not close the mesh, so that clean models stay bit for bit as they
// are.
Mesh weld_closed(const Mesh& mesh) {
  Mesh exact = weld(mesh);
  if (find_defects(exact).closed_and_oriented()) return exact;
  Mesh near = weld(mesh, flatness_tolerance(exact));
  return find_defects(near).closed_and_oriented() ? near : exact;
}

void check_size(const Scene& scene, const Candidate& c) {
  if (c.mesh.triangles.empty()) {
    throw bad_input(scene.file, fmt::format("mesh {} is flat: each of its triangles has two corners in one place",
                                            text::quoted(c.name)));
  }
  const Box box = bounds(c.mesh);
  const Vec3 extent = box.high - box.low;
  const double size = std::max({extent.x, extent.y, extent.z});
  double reach = 0;
  for (int i = 0; i < 3; ++i)
    reach = std::max({reach, std::abs(box.low[i]), std::abs(box.high[i])});
  if (!(std::max(size, reach) <= largest_size)) {
    throw bad_input(scene.file,
                    fmt::format("mesh {} reaches to {:.4g} m; a solid fits within a kilometre around the origin "
                                "(glTF's unit is the metre)",
                                text::quoted(c.name), std::max(size, reach)));
  }
  if (!(size >= smallest_size)) {
    throw bad_input(scene.file,
                    fmt::format("mesh {} is only {:.4g} m across; a solid has at least a micrometre (glTF's unit "
                                "is the metre)",
                                text::quoted(c.name), size));
  }
}

void check_closed(const Scene& scene, const Candidate& c) {
  const Defects d = find_defects(c.mesh);
  if (d.closed_and_oriented()) return;
  std::string fault = fmt::format("mesh {} is not a solid:", text::quoted(c.name));
  const char* separator = " ";
  const auto add = [&](std::uint64_t count, std::array<std::uint32_t, 2> first, const char* one, const char* many) {
    if (count == 0) return;
    fault += fmt::format("{}{} {} ({} {})", separator, count, count == 1 ? one : many,
                         count == 1 ? "it runs" : "the first runs", edge_text(c.mesh, first));
    separator = "; ";
  };
  add(d.open, d.first_open, "open edge", "open edges");
  add(d.non_manifold, d.first_non_manifold, "edge has more than two faces", "edges have more than two faces");
  add(d.flipped, d.first_flipped, "edge lies between faces of opposite orientation",
      "edges lie between faces of opposite orientation");
  throw bad_input(scene.file, fault + "; a solid's mesh is closed and consistently oriented");
}

Solid make_solid(const Scene& scene, Candidate c) {
  check_size(scene, c);
  check_closed(scene, c);
  const std::string name = text::quoted(c.name);
  const double tolerance = flatness_tolerance(c.mesh);
  const std::vector<std::uint32_t> twin_before = twins(c.mesh);
  const bool one_shell = count_shells(twin_before) == 1;
  const double volume = signed_volume(c.mesh);
  const Box box = bounds(c.mesh);
  if (!(std::abs(volume) > tolerance * area(c.mesh))) {
    throw bad_input(scene.file, fmt::format("mesh {} is flat: it encloses no volume ({:.3g} m3)", name, volume));
  }
  if (volume < 0) {
    log::warning(fmt::format("{}: mesh {} is inside out; its faces are turned", scene.file, name));
    flip(c.mesh);
  }
  const std::vector<std::uint32_t> twin = volume < 0 ? twins(c.mesh) : twin_before;
  Facets facets;
  if (one_shell && !has_reflex_edge(c.mesh, twin, tolerance)) {
    facets = find_facets(c.mesh, twin, tolerance);
    if (find_concavity(c.mesh, twin, facets, tolerance)) facets.planes.clear();
  }
  return {std::move(c.name), std::move(c.mesh), std::move(facets.planes), box, c.haptics};
}

// Groups of meshes that share an open edge, by position: pieces of one surface.
std::vector<std::vector<std::uint32_t>> pieces_that_meet(const std::vector<Candidate>& open) {
  Mesh all;
  std::vector<std::uint32_t> owner;
  for (std::uint32_t i = 0; i < open.size(); ++i) {
    append(all, open[i].mesh);
    owner.resize(all.triangles.size(), i);
  }
  // Not weld(): it drops triangles, and the owners go by them.
  const std::vector<std::uint32_t> index = weld_indices(all.positions, flatness_tolerance(all));
  for (glm::uvec3& t : all.triangles)
    t = glm::uvec3(index[t[0]], index[t[1]], index[t[2]]);
  UnionFind groups(open.size());
  const std::vector<Side> sides = sorted_sides(all);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high) {
      groups.join(owner[sides[i].side / 3], owner[sides[i + 1].side / 3]);
    }
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_first;
  for (std::uint32_t i = 0; i < open.size(); ++i)
    by_first[groups.find(i)].push_back(i);
  std::vector<std::vector<std::uint32_t>> result;
  result.reserve(by_first.size());
  for (auto& [first, members] : by_first)
    result.push_back(std::move(members));
  return result;
}

// One candidate per solid, in node order.
std::vector<Candidate> gather(const Scene& scene) {
  std::vector<std::pair<std::size_t, Candidate>> found;  // by the first node's place
  std::vector<Candidate> open;
  std::vector<std::size_t> open_place;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    if (!scene.meshes[i].haptics.touchable) continue;
    Candidate c{scene.meshes[i].name, weld_closed(scene.meshes[i].mesh), scene.meshes[i].haptics};
    const Defects d = find_defects(c.mesh);
    if (d.open > 0) {
      open.push_back(std::move(c));
      open_place.push_back(i);
    } else {
      found.emplace_back(i, std::move(c));
    }
  }
  for (const std::vector<std::uint32_t>& group : pieces_that_meet(open)) {
    Candidate whole = std::move(open[group[0]]);
    if (group.size() > 1) {
      for (std::size_t i = 1; i < group.size(); ++i)
        append(whole.mesh, open[group[i]].mesh);
      whole.mesh = weld_closed(whole.mesh);
    }
    found.emplace_back(open_place[group[0]], std::move(whole));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Candidate> result;
  result.reserve(found.size());
  for (auto& [place, candidate] : found)
    result.push_back(std::move(candidate));
  return result;
}

}  // namespace

double depth(const Solid& solid, const Vec3& point) {
  if (solid.planes.empty()) return surface_depth(solid.mesh, point);
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : solid.planes)
    least = std::min(least, plane.offset - glm::dot(plane.normal, point));
  return least;
}

std::vector<Solid> make_solids(const Scene& scene) {
  std::vector<Candidate> candidates = gather(scene);
  std::vector<Solid> solids;
  solids.reserve(candidates.size());
  for (Candidate& c : candidates)
    solids.push_back(make_solid(scene, std::move(c)));
  if (solids.empty())
    throw bad_input(scene.file, scene.meshes.empty()
                                    ? "the scene has no triangle mesh; a scene needs at least one solid"
                                    : "none of the scene's meshes is touchable; a scene needs at least one solid");
  return solids;
}

}  // namespace palpa::geometry
