#include "geometry/solid_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh_repair.hpp"
#include "geometry/mesh/self_intersection.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/surface/surface_triangles.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

constexpr double largest_size = 1e3, smallest_size = 1e-6;  // metres

std::string edge_text(const Mesh& mesh, std::array<std::uint32_t, 2> edge) {
  return fmt::format("from {} to {} m", text::point(mesh.positions[edge[0]]), text::point(mesh.positions[edge[1]]));
}

void check_size(const std::string& file, const std::string& name, const Mesh& mesh) {
  if (mesh.triangles.empty()) {
    throw bad_input(
        file,
        fmt::format(
            "mesh {} is flat: each of its triangles has two corners in the same place, or a duplicate back to back",
            name));
  }
  const Box box = bounds(mesh);
  const Vec3 extent = box.high - box.low;
  const double size = std::max({extent.x, extent.y, extent.z});
  const double reach = box.reach();
  if (!(std::max(size, reach) <= largest_size)) {
    throw bad_input(file, fmt::format("mesh {} reaches to {:.4g} m; a solid fits within a kilometre around the origin "
                                      "(glTF's unit is the metre)",
                                      name, std::max(size, reach)));
  }
  if (!(size >= smallest_size)) {
    throw bad_input(
        file, fmt::format(
                  "mesh {} is only {:.4g} m across; a solid measures at least a micrometre (glTF's unit is the metre)",
                  name, size));
  }
}

void check_closed(const std::string& file, const std::string& name, const Mesh& mesh) {
  const Defects d = find_defects(mesh);
  if (d.closed_and_oriented()) return;
  std::string fault = fmt::format("mesh {} is not a solid:", name);
  const char* separator = " ";
  const auto add = [&](std::uint64_t count, std::array<std::uint32_t, 2> first, const char* one, const char* many) {
    if (count == 0) return;
    fault += fmt::format("{}{} {} ({} {})", separator, count, count == 1 ? one : many,
                         count == 1 ? "it runs" : "the first runs", edge_text(mesh, first));
    separator = "; ";
  };
  add(d.open, d.first_open, "open edge", "open edges");
  add(d.non_manifold, d.first_non_manifold, "edge has more than two faces", "edges have more than two faces");
  add(d.flipped, d.first_flipped, "edge lies between faces of opposite orientation",
      "edges lie between faces of opposite orientation");
  throw bad_input(file, fault + "; a solid's mesh is closed and consistently oriented");
}

void check_volumes(const std::string& file, const std::string& name, const Mesh& mesh, const Shells& shells,
                   double tolerance) {
  double volume = 0, area = 0;
  for (const Shell& shell : shells.list) {
    volume += std::abs(shell.volume);
    area += shell.area;
  }
  if (!(volume > tolerance * area)) {
    throw bad_input(file, fmt::format("mesh {} is flat: it encloses no volume ({:.3g} m3)", name, volume));
  }
  for (const Shell& shell : shells.list) {
    // A speck smaller than the tolerance may still be a body, but not one without any volume.
    if (std::abs(shell.volume) > 1e-9 * shell.area * std::sqrt(shell.area)) continue;
    throw bad_input(
        file, fmt::format("mesh {} has a flat piece that encloses no volume, at {} m (triangle {}); remove it", name,
                          text::point(mesh.positions[mesh.triangles[shell.first][0]]), shell.first));
  }
}

std::optional<Crossing> find_crossing(const std::string& file, const std::string& name, const Mesh& mesh,
                                      const Bvh& bvh) {
  try {
    return find_self_intersection(mesh, bvh, most_pairs(mesh.triangles.size()));
  } catch (const Error& e) {
    throw bad_input(file, fmt::format("mesh {}: {}", name, e.what()));
  }
}

void check_crossings(const std::string& file, const std::string& name, const Mesh& mesh, const Bvh& bvh) {
  const auto crossing = find_crossing(file, name, mesh, bvh);
  if (!crossing) return;
  throw bad_input(file,
                  fmt::format("mesh {} passes through or touches itself: triangles {} and {} (after welding) meet "
                              "near {} m; mend it, or use --surface parts",
                              name, crossing->triangles[0], crossing->triangles[1], text::point(crossing->where)));
}

// The shells that face the wrong way as a whole; throws if a shell does not fit the shell around it.
std::vector<char> shells_to_turn(const std::string& file, const std::string& name, const Mesh& mesh,
                                 const Shells& shells) {
  std::vector<char> turned(shells.list.size(), 0);
  for (std::size_t s = 0; s < shells.list.size(); ++s) {
    const Shell& shell = shells.list[s];
    turned[s] = shells.list[shell.outermost].volume < 0 ? 1 : 0;
    const bool outwards = (shell.volume > 0) != (turned[s] != 0), should = shell.depth % 2 == 0;
    if (outwards == should) continue;
    throw bad_input(file,
                    fmt::format("mesh {} has a shell inside another that faces the same way, at {} m (triangle "
                                "{}): flip its faces if it is a cavity, or give it its own node if it is a second body",
                                name, text::point(mesh.positions[mesh.triangles[shell.first][0]]), shell.first));
  }
  return turned;
}

}  // namespace

SolidMesh weld_closed(const Mesh& mesh) {
  SolidMesh first{weld(mesh), {}, {}};
  Defects defects = find_defects(first.mesh);
  if (defects.closed_and_oriented()) return first;
  // So far from the origin that vertices coincide: refused for its position, not for the resulting faces.
  if (!(bounds(first.mesh).reach() <= largest_size)) return first;
  const auto without_duplicates = [](const Mesh& welded) {
    SolidMesh less{welded, {}, {}};
    const Dropped dropped = drop_duplicates(less.mesh);
    if (dropped.duplicates > 0)
      less.warnings.push_back(fmt::format("has {} duplicated faces; only one of each counts", dropped.duplicates));
    if (dropped.back_to_back > 0) {
      less.warnings.push_back(
          fmt::format("has {} pairs of equal faces back to back (walls without thickness), which palpa ignores",
                      dropped.back_to_back));
    }
    return less;
  };
  if (defects.non_manifold > 0) {
    SolidMesh less = without_duplicates(first.mesh);
    if (find_defects(less.mesh).closed_and_oriented()) return less;
  }
  SolidMesh near{weld(mesh, flatness_tolerance(first.mesh)), {}, {}};
  defects = find_defects(near.mesh);
  if (defects.closed_and_oriented()) return near;
  if (defects.non_manifold > 0) {
    SolidMesh less = without_duplicates(near.mesh);
    if (find_defects(less.mesh).closed_and_oriented()) return less;
  }
  return first;
}

void make_fit(const std::string& file, const std::string& name, SolidMesh& solid, bool may_cross) {
  Mesh& mesh = solid.mesh;
  check_size(file, name, mesh);
  check_closed(file, name, mesh);
  const double tolerance = flatness_tolerance(mesh);
  turn_needles(mesh, needle_width(tolerance));
  std::vector<std::uint32_t> twin = twins(mesh);
  Shells shells = find_shells(mesh, twin);
  check_volumes(file, name, mesh, shells, tolerance);
  std::optional<Bvh> bvh;
  const auto tree = [&]() -> const Bvh& {
    if (!bvh) bvh.emplace(mesh);
    return *bvh;
  };
  const auto turn = [&](const std::vector<char>& marked) {
    const auto count = static_cast<std::size_t>(std::count(marked.begin(), marked.end(), 1));
    if (count == 0) return;
    solid.warnings.push_back(
        count == marked.size()
            ? std::string("is inside out; its faces are turned")
            : fmt::format("is inside out in {} of its {} shells; their faces are turned", count, marked.size()));
    flip(mesh, shells, marked);
    twin = twins(mesh);
  };
  if (shells.list.size() == 1) {
    turn({shells.list[0].volume < 0 ? char{1} : char{0}});
    if (!has_reflex_edge(mesh, twin, tolerance)) {
      Facets facets = find_facets(mesh, twin, tolerance);
      if (!find_concavity(mesh, twin, facets, tolerance)) {
        solid.planes = std::move(facets.planes);
        return;
      }
    }
    if (!may_cross) check_crossings(file, name, mesh, tree());
    return;
  }
  if (may_cross && find_crossing(file, name, mesh, tree())) {
    // Nesting is meaningless then, so each shell is treated as a separate body.
    std::vector<char> inwards;
    for (const Shell& shell : shells.list)
      inwards.push_back(shell.volume < 0 ? 1 : 0);
    return turn(inwards);
  }
  if (!may_cross) check_crossings(file, name, mesh, tree());
  find_nesting(mesh, tree(), shells);
  turn(shells_to_turn(file, name, mesh, shells));
}

}  // namespace palpa::geometry
