#include "geometry/parts/decompose.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#include "geometry/mesh/nearest.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

constexpr double largest_size = 1e3, smallest_size = 1e-6;  // metres
constexpr std::uint32_t vertices_per_part = 64;             // V-HACD's own default
// Cuts run along voxels; their rims are then drawn to the surface, which moves neighbours apart by about a voxel. For
// the bunny in 32 parts, 6.6 % of the union's surface is a slit more than 3 mm inside if slits stay open, and 0.07 % if
// slits up to 1.5 voxels are closed; closing wider slits brings no further gain.
constexpr double seam_voxels = 1.5;
constexpr std::uint32_t error_samples = 40'000;

bool is_convex(const Mesh& mesh) {
  if (!find_defects(mesh).closed_and_oriented()) return false;
  const std::vector<std::uint32_t> twin = twins(mesh);
  if (find_shells(mesh, twin).list.size() != 1 || !(signed_volume(mesh) > 0)) return false;
  const double tolerance = flatness_tolerance(mesh);
  return !find_concavity(mesh, twin, find_facets(mesh, twin, tolerance), tolerance);
}

/// The mesh with each of its holes closed by a fan around the middle of its rim, so that flooding does not leak in.
Mesh without_holes(const Mesh& mesh) {
  // Along a rim: maps the start of an open side to its end, against the triangle's direction.
  std::map<std::uint32_t, std::uint32_t> rim;
  for_each_edge(mesh, [&](std::span<const Side> sides) {
    if (sides.size() > 1) return;
    const auto [from, to] = side_vertices(mesh, sides[0].side);
    rim.try_emplace(to, from);
  });
  Mesh closed = mesh;
  while (!rim.empty()) {
    std::vector<std::uint32_t> loop;
    Vec3 middle(0);
    for (auto next = rim.begin(); next != rim.end(); next = rim.find(loop.back())) {
      if (loop.empty()) loop.push_back(next->first);
      middle += mesh.positions[loop.back()];
      loop.push_back(next->second);
      rim.erase(next);
    }
    const auto centre = static_cast<std::uint32_t>(closed.positions.size());
    closed.positions.push_back(middle / static_cast<double>(loop.size() - 1));
    for (std::size_t i = 0; i + 1 < loop.size(); ++i)
      closed.triangles.emplace_back(loop[i], loop[i + 1], centre);
  }
  return closed;
}

/// The side of V-HACD's voxels, metres: its longest axis has roughly 1.5 times the cube root of the resolution in
/// voxels.
double voxel_side(const Mesh& mesh, std::uint32_t resolution) {
  const Box box = bounds(mesh);
  const Vec3 extent = box.high - box.low;
  const double along = std::max(32.0, std::floor(1.5 * std::pow(resolution, 0.33)));
  return std::max({extent.x, extent.y, extent.z}) / (along - 1);
}

/// One point in each of `count` sections of equal area.
std::vector<Vec3> spread_over(const Mesh& mesh, std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  const double whole = area(mesh);
  std::vector<Vec3> points;
  points.reserve(count);
  double before = 0;
  std::uint32_t triangle = 0;
  const auto size = [&] { return glm::length(area_vector(mesh, triangle)) / 2; };
  for (std::uint32_t i = 0; i < count && !mesh.triangles.empty(); ++i) {
    const double target = (i + random.uniform()) / count * whole;
    for (; triangle + 1 < mesh.triangles.size() && before + size() < target; ++triangle)
      before += size();
    const glm::uvec3& t = mesh.triangles[triangle];
    const double root = std::sqrt(random.uniform()), share = random.uniform();
    points.push_back(mesh.positions[t[0]] * (1 - root) + mesh.positions[t[1]] * (root * (1 - share)) +
                     mesh.positions[t[2]] * (root * share));
  }
  return points;
}

void add_triangle(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

/// The shells of a closed mesh that face inwards.
std::vector<Mesh> cavities_of(const Mesh& mesh) {
  if (!find_defects(mesh).closed_and_oriented()) return {};
  const Shells shells = find_shells(mesh, twins(mesh));
  std::vector<std::size_t> place(shells.list.size());
  std::size_t count = 0;
  for (std::size_t s = 0; s < place.size(); ++s)
    place[s] = shells.list[s].volume < 0 ? count++ : place.size();
  if (count == place.size()) return {};  // it is inside out
  std::vector<Mesh> cavities(count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t at = place[shells.of_triangle[t]];
    if (at == place.size()) continue;
    const glm::uvec3& v = mesh.triangles[t];
    add_triangle(cavities[at], mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
  }
  return cavities;
}

/// From points spread over one surface to the other.
Distances distances(const Mesh& from, const NearestTriangle& to, std::uint32_t samples, std::uint64_t seed) {
  Distances result;
  std::vector<double> found;
  const std::atomic<bool>* const stop = cancel_flag();
  for (const Vec3& p : spread_over(from, samples, seed)) {
    stop_if_cancelled(stop);
    found.push_back(to.distance(p));
    result.mean += found.back() / samples;
  }
  std::sort(found.begin(), found.end());
  if (found.empty()) return result;
  result.p95 = found[found.size() * 95 / 100];
  result.max = found.back();
  return result;
}

}  // namespace

std::string unfit_for_parts(const Mesh& mesh) {
  if (mesh.triangles.empty()) return "has no triangle with an area; there is nothing to take apart";
  const Box box = bounds(mesh);
  const Vec3 extent = box.high - box.low;
  const double size = std::max({extent.x, extent.y, extent.z}), least = std::min({extent.x, extent.y, extent.z});
  if (!(size <= largest_size) || !(size >= smallest_size)) {
    return fmt::format("is {:.4g} m across; a solid measures a micrometre to a kilometre (glTF's unit is the metre)",
                       size);
  }
  if (!(least > 1e-6 * size)) return "is flat: it has no extent along one axis, so there is no solid to take apart";
  return {};
}

std::optional<Parts> decompose(const Mesh& mesh, const DecomposeOptions& options, const Progress& progress) {
  Parts result;
  if (is_convex(mesh)) {
    if (std::optional<Part> whole = make_part(mesh.positions)) {
      result.parts.push_back(std::move(*whole));
      result.seam_m = smallest_seam(result.parts);
      return result;
    }
  }
  const VhacdOptions vhacd{options.parts, options.resolution, options.error_percent, vertices_per_part,
                           has_cavities(mesh)};
  bool cancelled = false;
  constexpr std::uint64_t thousandths = 1000;
  Activity work("cutting it into convex parts", thousandths);
  const std::atomic<bool>* const stop = cancel_flag();
  const auto hulls = vhacd_hulls(without_holes(mesh), vhacd, [&](double fraction) {
    work.reach(static_cast<std::uint64_t>(fraction * thousandths));
    cancelled = (progress && !progress(fraction)) || (stop && *stop);
    return !cancelled;
  });
  stop_if_cancelled(stop);
  if (cancelled) return std::nullopt;
  for (const std::vector<Vec3>& corners : hulls) {
    if (std::optional<Part> part = make_part(corners)) result.parts.push_back(std::move(*part));
  }
  if (result.parts.empty()) throw failure("V-HACD found nothing solid in the mesh; it needs a closed mesh");
  result.seam_m = std::max(smallest_seam(result.parts), seam_voxels * voxel_side(mesh, options.resolution));
  return result;
}

PartsReport measure(const Mesh& mesh, const Parts& parts, std::uint64_t seed) {
  const Activity work("measuring its parts");
  PartsReport report;
  report.parts = static_cast<std::uint32_t>(parts.parts.size());
  if (find_defects(mesh).closed_and_oriented()) report.mesh_volume_m3 = std::abs(signed_volume(mesh));
  const UnionSurface surface = union_surface(parts);
  report.union_volume_m3 = signed_volume(surface.mesh);
  double all = 0;
  for (const Part& part : parts.parts)
    all += area(part.mesh);
  report.internal_share = std::max(0.0, 1 - area(surface.mesh) / all);
  if (surface.mesh.triangles.empty()) return report;
  const NearestTriangle of_union(surface.mesh);
  const std::vector<Mesh> cavities = cavities_of(mesh);
  Activity sampling("comparing their surface with the mesh", 2 + cavities.size());
  report.surface_error_m = distances(surface.mesh, NearestTriangle(mesh), error_samples, seed);
  sampling.advance();
  report.mesh_error_m = distances(mesh, of_union, error_samples, seed);
  sampling.advance();
  for (const Mesh& cavity : cavities) {
    ++report.cavities;
    const auto samples = static_cast<std::uint32_t>(std::clamp<std::size_t>(error_samples / cavities.size(), 16, 1000));
    if (distances(cavity, of_union, samples, seed).mean > parts.seam_m) ++report.filled_cavities;
    sampling.advance();
  }
  return report;
}

bool has_cavities(const Mesh& mesh) {
  return !cavities_of(mesh).empty();
}

std::string lost_cavities(const PartsReport& report) {
  if (report.filled_cavities == 0) return {};
  return fmt::format(
      "has {} inside; its parts fill {}: use --surface mesh, or palpa decompose with a larger "
      "--resolution or --parts",
      counted(report.cavities, "cavity"), report.filled_cavities);
}

}  // namespace palpa::geometry
