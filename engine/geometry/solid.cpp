#include "geometry/solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/cache_file.hpp"
#include "base/log.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/parts_solid.hpp"
#include "geometry/rigid_copies.hpp"
#include "geometry/solid_mesh.hpp"
#include "geometry/surface/surface_depth.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

struct Candidate {
  std::string name;
  SolidMesh solid;  // welded
  Haptics haptics;
  std::optional<CacheKey> cache;  // where to store it once it is checked
  bool fit = false;
  std::size_t place = 0;  // index in the scene's meshes
};

/// Smaller meshes are checked faster than a cache file is found.
constexpr std::size_t worth_caching = 5000;  // triangles
/// Must change whenever make_fit() or weld_closed() judges or repairs differently.
constexpr std::uint32_t solid_version = 1;

std::optional<CacheKey> cache_key(const Mesh& mesh, SurfaceKind kind) {
  if (mesh.triangles.size() < worth_caching) return std::nullopt;
  CacheHash hash;
  hash.add(solid_version);
  hash.add(static_cast<std::uint32_t>(kind));
  hash.add(mesh.positions);
  hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
  return hash.key();
}

void store(const CacheKey& key, const SolidMesh& solid) {
  std::string warnings;
  for (const std::string& warning : solid.warnings)
    warnings += warning + '\n';
  const std::array sections{bytes_of(solid.mesh.positions), bytes_of(solid.mesh.triangles), bytes_of(solid.planes),
                            bytes_of(warnings)};
  store_cached("solid", key, sections);
}

std::optional<SolidMesh> load(const CacheKey& key) {
  const auto file = load_cached("solid", key);
  if (!file || file->sections.size() != 4) return std::nullopt;
  SolidMesh solid;
  const auto positions = file->section_as<Vec3>(0);
  const auto triangles = file->section_as<glm::uvec3>(1);
  const auto planes = file->section_as<Plane>(2);
  const auto warnings = file->section_as<char>(3);
  solid.mesh.positions.assign(positions.begin(), positions.end());
  solid.mesh.triangles.assign(triangles.begin(), triangles.end());
  solid.planes.assign(planes.begin(), planes.end());
  for (auto begin = warnings.begin(); begin != warnings.end();) {
    const auto end = std::find(begin, warnings.end(), '\n');
    solid.warnings.emplace_back(begin, end);
    begin = end == warnings.end() ? end : end + 1;
  }
  return solid;
}

/// The treatment of meshes that no repair closes.
enum class Open { refused, kept };

Solid make_solid(const std::string& file, Candidate c, SurfaceKind kind, Open open) {
  const std::string name = text::quoted(c.name);
  const bool keep = open == Open::kept && !c.fit && !find_defects(c.solid.mesh).closed_and_oriented();
  if (!c.fit && !keep) {
    log::debug(fmt::format("{}: mesh {} of {} triangles is checked", file, name, c.solid.mesh.triangles.size()));
    const Activity work(fmt::format("checking mesh {} of {} triangles", name, c.solid.mesh.triangles.size()));
    make_fit(file, name, c.solid, kind == SurfaceKind::parts);
    if (c.cache) store(*c.cache, c.solid);
  }
  for (const std::string& warning : c.solid.warnings)
    log::warning(fmt::format("{}: mesh {} {}", file, name, warning));
  const Box box = bounds(c.solid.mesh);
  Solid solid{std::move(c.name), std::move(c.solid.mesh), std::move(c.solid.planes), box};
  solid.haptics = c.haptics;
  solid.file = file;
  return solid;
}

/// Assembles `mesh` as `made` was assembled from a rigid copy of it.
Mesh put_together(const Mesh& mesh, const std::vector<std::uint32_t>& vertices, const Mesh& made) {
  Mesh out{{}, made.triangles};
  out.positions.reserve(vertices.size());
  for (const std::uint32_t v : vertices)
    out.positions.push_back(mesh.positions[v] + Vec3(0.0));  // no negative zeros, as after weld()
  return out;
}

/// The solid of `mesh`, a rigid copy of the scene's mesh `original`, from which the solid `first` was made.
Solid make_copy(const SceneMesh& original, const Solid& first, const std::vector<std::uint32_t>& vertices,
                const SceneMesh& mesh) {
  Solid solid;
  solid.name = mesh.name;
  solid.haptics = mesh.haptics;
  solid.file = first.file;
  solid.mesh = put_together(mesh.mesh, vertices, first.mesh);
  solid.bounds = bounds(solid.mesh);
  const Transform T = mesh.copy->T_world_mesh * glm::inverse(original.copy->T_world_mesh);
  for (const Plane& plane : first.planes)
    solid.planes.push_back(moved(plane, T));
  solid.copy = {first.copy.shape, mesh.copy->T_world_mesh};
  return solid;
}

// Groups of meshes that share an open edge, by position: pieces of one surface.
std::vector<std::vector<std::uint32_t>> pieces_that_meet(const std::vector<Candidate>& open) {
  Mesh all;
  std::vector<std::uint32_t> owner;
  for (std::uint32_t i = 0; i < open.size(); ++i) {
    append(all, open[i].solid.mesh);
    owner.resize(all.triangles.size(), i);
  }
  // Not weld(), because it drops triangles, and the owners are stored per triangle.
  const std::vector<std::uint32_t> index = weld_indices(all.positions, flatness_tolerance(all));
  for (glm::uvec3& t : all.triangles)
    t = glm::uvec3(index[t[0]], index[t[1]], index[t[2]]);
  UnionFind groups(open.size());
  for_each_edge(all, [&](std::span<const Side> sides) {
    for (const Side& side : sides)
      groups.join(owner[sides[0].side / 3], owner[side.side / 3]);
  });
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_first;
  for (std::uint32_t i = 0; i < open.size(); ++i)
    by_first[groups.find(i)].push_back(i);
  std::vector<std::vector<std::uint32_t>> result;
  result.reserve(by_first.size());
  for (auto& [first, members] : by_first)
    result.push_back(std::move(members));
  return result;
}

Candidate begin(const SceneMesh& mesh, std::size_t place) {
  return {mesh.name, {}, mesh.haptics, std::nullopt, false, place};
}

// The scene's meshes, each welded separately, closed or not.
struct Gathered {
  std::vector<Candidate> closed, open;
  std::vector<std::pair<std::size_t, std::size_t>> copies;  // of closed ones: their own index, the first one's
};

Gathered gather_meshes(const Scene& scene, SurfaceKind kind) {
  Gathered out;
  const std::vector<std::uint32_t> first = find_rigid_copies(scene);
  std::map<std::size_t, std::vector<std::uint32_t>> vertices;  // of open ones that have copies
  std::map<std::size_t, std::size_t> open_place;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const SceneMesh& mesh = scene.meshes[i];
    if (!mesh.haptics.touchable || mesh.part) continue;
    Candidate c = begin(mesh, i);
    const std::size_t f = first[i];
    const auto open_first = open_place.find(f);
    if (f != i && open_first == open_place.end()) {
      out.copies.emplace_back(i, f);
      continue;
    }
    if (f != i) {
      const Mesh& made = out.open[open_first->second].solid.mesh;
      auto& known = vertices[f];
      if (known.empty()) known = vertices_of(scene.meshes[f].mesh, made);
      c.solid = known.empty() ? weld_closed(mesh.mesh) : SolidMesh{put_together(mesh.mesh, known, made), {}, {}};
      out.open.push_back(std::move(c));
      continue;
    }
    c.cache = cache_key(mesh.mesh, kind);
    if (c.cache) {
      if (auto cached = load(*c.cache)) {
        c.solid = std::move(*cached);
        c.fit = true;
        out.closed.push_back(std::move(c));
        continue;
      }
    }
    const Activity work(
        fmt::format("welding mesh {} of {} triangles", text::quoted(c.name), mesh.mesh.triangles.size()));
    c.solid = weld_closed(mesh.mesh);
    if (find_defects(c.solid.mesh).open > 0) {
      c.cache.reset();
      open_place.emplace(i, out.open.size());
      out.open.push_back(std::move(c));
    } else {
      out.closed.push_back(std::move(c));
    }
  }
  return out;
}

// Open meshes that are closed together become one mesh, at the index of the first.
std::vector<Candidate> join_pieces(std::vector<Candidate> open) {
  std::vector<Candidate> joined;
  for (const std::vector<std::uint32_t>& group : pieces_that_meet(open)) {
    Candidate whole = std::move(open[group[0]]);
    if (group.size() > 1) {
      for (std::size_t i = 1; i < group.size(); ++i)
        append(whole.solid.mesh, open[group[i]].solid.mesh);
      whole.solid = weld_closed(whole.solid.mesh);
    }
    joined.push_back(std::move(whole));
  }
  return joined;
}

std::vector<Solid> solids_of(const Scene& scene, SurfaceKind kind, Open open) {
  std::vector<std::pair<std::size_t, Solid>> found = solids_of_parts(scene);
  Gathered gathered = gather_meshes(scene, kind);
  const std::size_t alone = gathered.closed.size();
  for (Candidate& c : join_pieces(std::move(gathered.open)))
    gathered.closed.push_back(std::move(c));
  const std::size_t first_closed = found.size();
  std::map<std::size_t, std::size_t> solid_at;  // of a closed mesh, by its index
  for (std::size_t i = 0; i < gathered.closed.size(); ++i) {
    Candidate& c = gathered.closed[i];
    const std::size_t place = c.place;
    if (i < alone) solid_at.emplace(place, first_closed + i);
    found.emplace_back(place, make_solid(scene.file, std::move(c), kind, open));
  }
  std::map<std::size_t, std::vector<std::uint32_t>> vertices;
  for (const auto& [place, f] : gathered.copies) {
    const SceneMesh &original = scene.meshes[f], &mesh = scene.meshes[place];
    const std::size_t first = solid_at.at(f);
    auto& known = vertices[f];
    if (known.empty()) {
      known = vertices_of(original.mesh, found[first].second.mesh);
      found[first].second.copy = {std::make_shared<int>(), original.copy->T_world_mesh};
    }
    found.emplace_back(place, make_copy(original, found[first].second, known, mesh));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Solid> solids;
  solids.reserve(found.size());
  for (auto& [place, solid] : found)
    solids.push_back(std::move(solid));
  if (solids.empty()) {
    const std::string fault =
        scene.meshes.empty() ? "the scene has no triangle mesh" : "none of its meshes is touchable";
    throw bad_input(scene.file, fault + (scene.hidden.empty() ? "" : " (" + scene.hidden + ")") +
                                    "; a scene needs at least one solid");
  }
  return solids;
}

}  // namespace

double depth(const Solid& solid, const Vec3& point) {
  if (!solid.parts.parts.empty()) return depth(solid.parts, solid.internal_faces, point);
  if (solid.planes.empty()) return surface_depth(solid.mesh, point);
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : solid.planes)
    least = std::min(least, plane.offset - glm::dot(plane.normal, point));
  return least;
}

std::vector<Solid> make_solids(const Scene& scene, SurfaceKind kind) {
  return solids_of(scene, kind, Open::refused);
}

std::vector<Solid> solids_to_decompose(const Scene& scene) {
  return solids_of(scene, SurfaceKind::parts, Open::kept);
}

}  // namespace palpa::geometry
