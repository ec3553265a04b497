#include "geometry/surface/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/files/cache_file.hpp"
#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/topology.hpp"
#include "geometry/parts/convex.hpp"
#include "geometry/surface/surface_cells.hpp"
#include "geometry/surface/surface_samples.hpp"
#include "geometry/surface/surface_triangles.hpp"

namespace palpa::geometry {
namespace {

struct Memory {
  SurfaceTriangles triangles;
  SurfaceCells cells;
};

/// Meshes with fewer triangles are prepared faster than a cache file is found.
constexpr std::size_t worth_caching = 5000;
/// Must change whenever the same mesh gives other cells or triangles.
constexpr std::uint32_t surface_version = 3;

/// All members of a Surface except the spans, as stored in the cache.
struct Frame {
  Vec3 centre, low, high;
  double cell_m;
  glm::uvec3 grid;
  std::uint32_t longest;
};

CacheKey cache_key(const Mesh& mesh, const SurfaceOptions& options) {
  CacheHash hash;
  hash.add(surface_version);
  hash.add(options.reach_m);
  hash.add(static_cast<std::uint32_t>(options.deep));
  if (options.least_cells != SurfaceOptions().least_cells) hash.add(options.least_cells);
  hash.add(mesh.positions);
  hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
  return hash.key();
}

std::optional<Surface> load(const CacheKey& key, const SurfaceOptions& options) {
  const auto file = load_cached("surface", key);
  if (!file || file->sections.size() != 6) return std::nullopt;
  const auto frame = file->section_as<Frame>(0);
  Surface out;
  out.cells = file->section_as<shader::SurfaceCell>(1);
  out.runs = file->section_as<std::uint32_t>(2);
  out.triangles = file->section_as<shader::SurfaceTriangle>(3);
  out.signs = file->section_as<shader::SurfaceSigns>(4);
  out.corners = file->section_as<shader::vec4>(5);
  if (frame.size() != 1 || out.signs.size() != out.triangles.size()) return std::nullopt;
  out.centre = frame[0].centre;
  out.low = frame[0].low;
  out.high = frame[0].high;
  out.cell_m = frame[0].cell_m;
  out.grid = frame[0].grid;
  out.longest = frame[0].longest;
  out.options = options;
  out.memory = file;
  return out;
}

void store(const CacheKey& key, const Surface& surface) {
  const std::array frame{
      Frame{surface.centre, surface.low, surface.high, surface.cell_m, surface.grid, surface.longest}};
  const std::array<std::span<const std::byte>, 6> sections{
      std::as_bytes(std::span(frame)),  std::as_bytes(surface.cells), std::as_bytes(surface.runs),
      std::as_bytes(surface.triangles), std::as_bytes(surface.signs), std::as_bytes(surface.corners)};
  store_cached("surface", key, sections);
}

Surface build(const Mesh& mesh, const SurfaceOptions& options) {
  const Box world = bounds(mesh);
  Surface out;
  out.centre = Vec3(glm::vec3(world.centre()));
  const double margin = 1e-6 * glm::length(world.high - world.low) + 1e-9;
  const Box box{world.low - out.centre - margin, world.high - out.centre + margin};
  auto memory = std::make_shared<Memory>();
  const Bvh bvh(mesh);
  memory->triangles =
      make_surface_triangles(mesh, twins(mesh), bvh.order(), out.centre, needle_width(flatness_tolerance(mesh)));
  memory->cells = make_surface_cells(bvh, memory->triangles, out.centre, box, options);
  out.options = options;
  out.low = memory->cells.low;
  out.high = box.high;
  out.cell_m = memory->cells.cell_m;
  out.grid = memory->cells.grid;
  out.longest = memory->cells.longest;
  out.cells = memory->cells.cells;
  out.runs = memory->cells.runs;
  out.triangles = memory->triangles.triangles;
  out.signs = memory->triangles.signs;
  out.corners = memory->triangles.corners;
  out.memory = std::move(memory);
  return out;
}

}  // namespace

Surface make_surface(const Mesh& mesh, const SurfaceOptions& options) {
  if (mesh.triangles.size() < worth_caching) return build(mesh, options);
  const CacheKey key = cache_key(mesh, options);
  if (auto cached = load(key, options)) return std::move(*cached);
  Surface surface = build(mesh, options);
  store(key, surface);
  return surface;
}

Place find_place(const Surface& s, const glm::vec3& p, float delta) {
  const auto density = static_cast<float>(1 / s.cell_m);
  std::array<std::uint32_t, 3> cell{};
  std::array<float, 3> rest{};
  for (int i = 0; i < 3; ++i) {
    const float along = (p[i] - static_cast<float>(s.low[i])) * density;
    cell[i] = std::min(static_cast<std::uint32_t>(std::max(along, 0.0F)), s.grid[i] - 1);
    rest[i] = along - static_cast<float>(cell[i]);
  }
  shader::SurfaceCell here = s.cells[(std::size_t{cell[2]} * s.grid.y + cell[1]) * s.grid.x + cell[0]];
  for (std::uint32_t level = 0; level < shader::surface_most_levels; ++level) {
    if ((here.kind & shader::surface_kinds) != shader::surface_divided) break;
    std::uint32_t child = 0;
    for (int i = 0; i < 3; ++i) {
      rest[i] *= 2;
      const bool upper = rest[i] >= 1;
      if (upper) rest[i] -= 1;
      child |= static_cast<std::uint32_t>(upper) << i;
    }
    here = s.cells[here.first + child];
  }
  const std::uint32_t kind = here.kind & shader::surface_kinds, count = here.kind & ~shader::surface_kinds;
  if (kind == shader::surface_outside) return {};
  Place place{Region::deep, 0, 0};
  float least = std::numeric_limits<float>::max();
  for (std::uint32_t r = here.first; r < here.first + count; ++r) {
    const std::uint32_t first = s.runs[r] & (shader::surface_most_triangles - 1);
    const std::uint32_t last = first + (s.runs[r] >> shader::surface_run_bits);
    for (std::uint32_t t = first; t <= last; ++t) {
      const float d = shader::surface_distance2(s.triangles[t], float3(p));
      if (d < least) {
        least = d;
        place.triangle = t;
      }
    }
  }
  if (count > 0) place.depth_m = std::sqrt(least);
  if (kind == shader::surface_deep) return place;
  if (!(least > 0) || !is_inside(s.triangles[place.triangle], s.signs[place.triangle], s.corners, p)) return {};
  if (least < delta * delta) place.region = Region::shell;
  return place;
}

}  // namespace palpa::geometry
