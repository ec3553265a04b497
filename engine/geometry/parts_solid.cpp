#include "geometry/parts_solid.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/cache_file.hpp"
#include "base/log.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

[[noreturn]] void refuse(const Scene& scene, const SceneMesh& mesh, const std::string& fault) {
  throw bad_input(scene.file, fmt::format("mesh {}, a part of {}, {}", text::quoted(mesh.name),
                                          text::quoted(mesh.part->solid), fault));
}

Part read_part(const Scene& scene, const SceneMesh& mesh) {
  const Mesh welded = weld(mesh.mesh);
  const Defects defects = find_defects(welded);
  if (welded.triangles.empty() || !defects.closed_and_oriented()) {
    refuse(scene, mesh, "is not closed and consistently oriented; a part is a closed convex mesh");
  }
  const std::vector<std::uint32_t> twin = twins(welded);
  if (find_shells(welded, twin).list.size() != 1)
    refuse(scene, mesh, "is in several pieces; a part is one convex mesh");
  std::optional<Part> part = make_part(welded.positions);
  if (!part) refuse(scene, mesh, "is flat; a part encloses a volume");
  const double tolerance = flatness_tolerance(welded);
  const Facets facets = find_facets(welded, twin, tolerance);
  if (const auto reflex = find_concavity(welded, twin, facets, tolerance)) {
    refuse(scene, mesh,
           fmt::format("is concave: its surface bends inwards by {:.3g} degrees near {}; a part is convex",
                       reflex->angle * 180 / std::numbers::pi, text::point(welded.positions[reflex->vertices[0]])));
  }
  // Faults that no edge shows: a surface that passes through itself, or is inside out.
  const double hull = signed_volume(part->mesh), own = signed_volume(welded);
  if (std::abs(hull - own) > 1e-3 * hull) refuse(scene, mesh, "does not enclose its convex hull; a part is convex");
  return std::move(*part);
}

void finish(Solid& solid) {
  solid.mesh = {};
  solid.bounds = {};
  for (const Part& part : solid.parts.parts) {
    append(solid.mesh, part.mesh);
    solid.bounds.add(part.bounds.low);
    solid.bounds.add(part.bounds.high);
  }
  solid.planes.clear();
}

}  // namespace

std::vector<std::pair<std::size_t, Solid>> solids_of_parts(const Scene& scene) {
  std::vector<std::pair<std::size_t, Solid>> solids;
  std::map<std::pair<std::string, std::uint32_t>, std::size_t> known;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const SceneMesh& mesh = scene.meshes[i];
    if (!mesh.part || !mesh.haptics.touchable) continue;
    const auto [place, fresh] = known.try_emplace({mesh.part->solid, mesh.part->group}, solids.size());
    if (fresh) {
      Solid solid;
      solid.name = mesh.part->solid;
      solid.haptics = mesh.haptics;
      solid.file = scene.file;
      solids.emplace_back(i, std::move(solid));
    }
    Parts& parts = solids[place->second].second.parts;
    if (parts.parts.size() == most_parts) {
      refuse(scene, mesh, fmt::format("is one too many: a solid has at most {} parts", most_parts));
    }
    parts.parts.push_back(read_part(scene, mesh));
    parts.seam_m = std::max(parts.seam_m, mesh.part->seam_m);
  }
  for (auto& [place, solid] : solids) {
    solid.parts.seam_m = std::max(solid.parts.seam_m, smallest_seam(solid.parts.parts));
    finish(solid);
  }
  return solids;
}

namespace {

/// Must change whenever the same mesh and options give other parts.
constexpr std::uint32_t parts_version = 2;

CacheKey cache_key(const Mesh& mesh, const DecomposeOptions& options) {
  CacheHash hash;
  hash.add(parts_version);
  hash.add(options.parts);
  hash.add(options.resolution);
  hash.add(options.error_percent);
  hash.add(mesh.positions);
  hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
  return hash.key();
}

/// Stores each part's corners, from which the hull is made again with the same bits.
void store(const CacheKey& key, const Parts& parts) {
  std::vector<std::uint64_t> sizes;
  std::vector<Vec3> corners;
  for (const Part& part : parts.parts) {
    sizes.push_back(part.mesh.positions.size());
    corners.insert(corners.end(), part.mesh.positions.begin(), part.mesh.positions.end());
  }
  const std::vector<double> seam{parts.seam_m};
  const std::array sections{bytes_of(seam), bytes_of(sizes), bytes_of(corners)};
  store_cached("parts", key, sections);
}

std::optional<Parts> load(const CacheKey& key) {
  const auto file = load_cached("parts", key);
  if (!file || file->sections.size() != 3) return std::nullopt;
  const auto seam = file->section_as<double>(0);
  const auto sizes = file->section_as<std::uint64_t>(1);
  auto corners = file->section_as<Vec3>(2);
  if (seam.size() != 1 || sizes.empty() || sizes.size() > most_parts) return std::nullopt;
  Parts parts{{}, seam[0]};
  for (const std::uint64_t size : sizes) {
    if (size > corners.size()) return std::nullopt;
    std::optional<Part> part = make_part(corners.first(size));
    if (!part) return std::nullopt;
    parts.parts.push_back(std::move(*part));
    corners = corners.subspan(size);
  }
  return parts;
}

}  // namespace

bool use_parts(Solid& solid, const DecomposeOptions& options, const Progress& progress) {
  try {
    const CacheKey key = cache_key(solid.mesh, options);
    std::optional<Parts> parts = load(key);
    if (!parts) {
      const Activity work(fmt::format("taking mesh {} apart", text::quoted(solid.name)));
      parts = decompose(solid.mesh, options, progress);
      if (!parts) return false;
      store(key, *parts);
    }
    if (has_cavities(solid.mesh)) {
      if (const std::string lost = lost_cavities(measure(solid.mesh, *parts, 0)); !lost.empty())
        log::warning(fmt::format("{}: mesh {} {}", solid.file, text::quoted(solid.name), lost));
    }
    solid.parts = std::move(*parts);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("mesh {}: {}", text::quoted(solid.name), error.what()));
  }
  finish(solid);
  return true;
}

}  // namespace palpa::geometry
