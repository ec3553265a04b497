#include "touch/plane_cells.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/error.hpp"
#include "touch/foci.hpp"
#include "touch/parts_table.hpp"

namespace palpa::touch {
namespace {

/// Below this, cells are not refined further: no sensible delta reaches there.
constexpr double refined_depth = 5e-3;
/// A solid with more planes than that is asked by its surface, where it has a mesh.
constexpr std::size_t most_planes = 4096;
/// A list this short is not worth splitting.
constexpr std::size_t short_list = 1;
/// All lists of a scene together, at 16 bytes each; a solid that would go beyond keeps one list of all its planes.
constexpr std::size_t most_listed = std::size_t{3} << 20;

std::uint32_t cells_per_axis(std::size_t planes) {
  if (planes <= 128) return 8;
  return planes <= 512 ? 16 : 32;
}

struct LocalPlane {
  Vec3 normal;
  double offset;
};

shader::vec4 to_float(const LocalPlane& p) {
  return {static_cast<float>(p.normal.x), static_cast<float>(p.normal.y), static_cast<float>(p.normal.z),
          static_cast<float>(p.offset)};
}

float rounded_down(double value) {
  const float f = static_cast<float>(value);
  return f > value ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float rounded_up(double value) {
  return -rounded_down(-value);
}

double spread(const Vec3& direction, const Vec3& half) {
  return std::abs(direction.x) * half.x + std::abs(direction.y) * half.y + std::abs(direction.z) * half.z;
}

/// Refines one solid's box as an octree whose leaves fill ranges of a flat grid.
class Grid {
 public:
  Grid(const std::vector<LocalPlane>& planes, const Vec3& low, const Vec3& high, std::uint32_t per_axis)
      : planes_(&planes), low_(low), size_((high - low) / static_cast<double>(per_axis)), per_axis_(per_axis) {
    // What float arithmetic can be wrong by: a few roundings at the size of the box.
    const Vec3 extent = high - low;
    margin_ = 1e-6 * (extent.x + extent.y + extent.z);
    cells.resize(std::size_t{per_axis} * per_axis * per_axis);
  }

  /// False when the lists would grow beyond `most` planes.
  bool build(std::size_t most) {
    most_ = most;
    std::vector<std::uint32_t> all(planes_->size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
      all[i] = i;
    return refine(glm::uvec3(0), per_axis_, all);
  }

  std::vector<shader::PlaneCell> cells;
  std::vector<std::uint32_t> list;

 private:
  bool refine(const glm::uvec3& first, std::uint32_t width, const std::vector<std::uint32_t>& inherited) {
    // A hundredth of a cell covers how far rounding can move a point across a cell's side.
    const std::vector<LocalPlane>& planes = *planes_;
    const Vec3 half = size_ * (0.5 * width + 0.01);
    const Vec3 centre = low_ + size_ * (Vec3(first) + Vec3(0.5 * width));
    double deepest = std::numeric_limits<double>::infinity(), shallowest = deepest, nearest_depth = deepest;
    std::uint32_t nearest = 0;
    for (const std::uint32_t m : inherited) {
      const double depth = planes[m].offset - glm::dot(planes[m].normal, centre);
      const double reach = spread(planes[m].normal, half);
      deepest = std::min(deepest, depth + reach);
      shallowest = std::min(shallowest, depth - reach);
      if (depth < nearest_depth) {
        nearest_depth = depth;
        nearest = m;
      }
    }
    deepest += margin_;
    shallowest -= margin_;
    std::vector<std::uint32_t> kept;
    if (deepest > 0) {
      for (const std::uint32_t m : inherited) {
        const double behind = planes[m].offset - glm::dot(planes[m].normal, centre) - nearest_depth;
        if (behind <= spread(planes[m].normal - planes[nearest].normal, half) + margin_) kept.push_back(m);
      }
      if (width > 1 && kept.size() > short_list && shallowest < refined_depth) {
        const std::uint32_t child = width / 2;
        for (std::uint32_t c = 0; c < 8; ++c) {
          const glm::uvec3 step(c & 1U, c >> 1 & 1U, c >> 2);
          if (!refine(first + step * child, child, kept)) return false;
        }
        return true;
      }
    }
    if (list.size() + kept.size() > most_) return false;
    const shader::PlaneCell cell{static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(kept.size()),
                                 rounded_down(shallowest), rounded_up(deepest)};
    list.insert(list.end(), kept.begin(), kept.end());
    for (std::uint32_t z = first.z; z < first.z + width; ++z) {
      for (std::uint32_t y = first.y; y < first.y + width; ++y) {
        const std::size_t row = (std::size_t{z} * per_axis_ + y) * per_axis_ + first.x;
        std::fill_n(cells.begin() + static_cast<std::ptrdiff_t>(row), width, cell);
      }
    }
    return true;
  }

  const std::vector<LocalPlane>* planes_;
  Vec3 low_, size_;
  std::uint32_t per_axis_;
  double margin_ = 0;
  std::size_t most_ = 0;
};

void add_solid(PlaneTable& table, std::size_t& listed, const geometry::Solid& solid,
               const std::vector<LocalPlane>& planes, std::uint32_t first_plane) {
  const Vec3 extent = solid.bounds.high - solid.bounds.low;
  const double margin = 1e-6 * (extent.x + extent.y + extent.z) + 1e-9;
  const Vec3 centre(glm::vec3(solid.bounds.centre()));  // as the shader will have it
  const Vec3 low = solid.bounds.low - centre - margin, high = solid.bounds.high - centre + margin;

  shader::SolidRecord record{};
  record.centre = {static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z), 0};
  record.low = {rounded_down(low.x), rounded_down(low.y), rounded_down(low.z), 0};
  record.high = {rounded_up(high.x), rounded_up(high.y), rounded_up(high.z), 0};
  record.delta = static_cast<float>(solid.haptics.delta_m.value_or(0));
  record.first_cell = static_cast<std::uint32_t>(table.cells.size());
  record.cells_per_axis = cells_per_axis(planes.size());

  Grid grid(planes, low, high, record.cells_per_axis);
  if (!grid.build(most_listed - std::min(most_listed, listed))) {
    record.cells_per_axis = 1;
    grid = Grid(planes, low, high, 1);
    grid.build(planes.size());
  }
  const Vec3 density = static_cast<double>(record.cells_per_axis) / (high - low);
  record.cells_per_metre = {static_cast<float>(density.x), static_cast<float>(density.y), static_cast<float>(density.z),
                            1};
  table.solids.push_back(record);
  table.centres.push_back(centre);
  const auto base = static_cast<std::uint32_t>(table.planes.size());
  for (shader::PlaneCell cell : grid.cells) {
    cell.first += base;
    table.cells.push_back(cell);
  }
  for (const std::uint32_t m : grid.list)
    table.planes.push_back(table.planes[first_plane + m]);
  listed += grid.list.size();
}

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool asked_by_surface(const geometry::Solid& solid) {
  return !solid.mesh.triangles.empty() && (solid.planes.empty() || solid.planes.size() > most_planes);
}

void add_surface(PlaneTable& table, SurfaceBase& next, const geometry::Solid& solid, const Parameters& parameters) {
  geometry::Surface surface = geometry::make_surface(
      solid.mesh, {.reach_m = solid.haptics.delta_m.value_or(parameters.delta_m), .deep = parameters.wants_deep()});
  shader::SolidRecord record{};
  const auto f = [](double v) { return static_cast<float>(v); };
  record.centre = {f(surface.centre.x), f(surface.centre.y), f(surface.centre.z), 0};
  record.low = {f(surface.low.x), f(surface.low.y), f(surface.low.z), 0};
  record.high = {f(surface.high.x), f(surface.high.y), f(surface.high.z), 0};
  const float density = f(1 / surface.cell_m);
  record.cells_per_metre = {density, density, density, 1};
  record.first_cell = next.cells;
  record.cells_per_axis =
      surface.grid.x | surface.grid.y << shader::surface_axis_bits | surface.grid.z << 2 * shader::surface_axis_bits;
  record.delta = f(solid.haptics.delta_m.value_or(0));
  record.by_surface = shader::asked_by_surface;
  table.solids.push_back(record);
  table.centres.push_back(surface.centre);
  table.surface_base.push_back(next);
  if (surface.triangles.size() > shader::surface_most_triangles - next.triangles) {
    throw bad_usage(fmt::format("the scene's solids have more than {} triangles together: give fewer or coarser ones",
                                shader::surface_most_triangles));
  }
  next.cells += static_cast<std::uint32_t>(surface.cells.size());
  next.runs += static_cast<std::uint32_t>(surface.runs.size());
  next.triangles += static_cast<std::uint32_t>(surface.triangles.size());
  next.corners += static_cast<std::uint32_t>(surface.corners.size());
  table.surfaces.push_back(std::move(surface));
}

bool asked_by_parts(const geometry::Solid& solid) {
  return !solid.parts.parts.empty();
}

void add_solid_of_parts(PlaneTable& table, const geometry::Solid& solid) {
  const PartsGrid grid = add_parts(table.parts, solid.parts, solid.internal_faces);
  shader::SolidRecord record{};
  record.centre = {grid.centre.x, grid.centre.y, grid.centre.z, 0};
  record.low = {grid.low.x, grid.low.y, grid.low.z, 0};
  record.high = {grid.high.x, grid.high.y, grid.high.z, 0};
  record.cells_per_metre = {grid.cells_per_metre.x, grid.cells_per_metre.y, grid.cells_per_metre.z, 1};
  record.first_cell = grid.base;
  record.cells_per_axis = grid.cells_per_axis;
  record.delta = static_cast<float>(solid.haptics.delta_m.value_or(0));
  record.by_surface = shader::asked_by_parts;
  table.solids.push_back(record);
  table.centres.emplace_back(grid.centre);
}

}  // namespace

PlaneTable make_plane_table(const std::vector<geometry::Solid>& solids, const Parameters& parameters) {
  PlaneTable table;
  table.foci_of = foci_of_solids(solids);
  std::vector<std::vector<LocalPlane>> local(solids.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const geometry::Solid& solid = solids[s];
    const bool by_surface = asked_by_parts(solid) || asked_by_surface(solid);
    bool usable = (by_surface || !solid.planes.empty()) && !solid.bounds.empty() && finite(solid.bounds.low) &&
                  finite(solid.bounds.high);
    const Vec3 centre(glm::vec3(solid.bounds.centre()));
    table.first_plane.push_back(static_cast<std::uint32_t>(table.planes.size()));
    for (const geometry::Plane& plane : solid.planes) {
      if (by_surface) break;
      local[s].push_back({plane.normal, plane.offset - glm::dot(plane.normal, centre)});
      table.planes.push_back(to_float(local[s].back()));
      usable = usable && finite(plane.normal) && std::isfinite(plane.offset);
    }
    if (!usable) throw bad_usage(fmt::format("solid '{}' has no planes or no finite box", solid.name));
  }
  table.first_plane.push_back(static_cast<std::uint32_t>(table.planes.size()));
  std::size_t listed = 0;
  SurfaceBase next;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    if (!asked_by_parts(solids[s]) && asked_by_surface(solids[s])) {
      add_surface(table, next, solids[s], parameters);
      continue;
    }
    if (asked_by_parts(solids[s])) {
      add_solid_of_parts(table, solids[s]);
    } else {
      add_solid(table, listed, solids[s], local[s], table.first_plane[s]);
    }
    table.surfaces.emplace_back();
    table.surface_base.push_back(next);
  }
  return table;
}

void set_pose(PlaneTable& table, std::uint32_t solid, const Transform& T_world_rest) {
  if (solid >= table.solids.size()) {
    throw bad_usage(fmt::format("pose of solid {}: the scene has {} solids", solid, table.solids.size()));
  }
  const glm::dmat3 R(T_world_rest);
  const glm::dmat3 square = glm::transpose(R) * R - glm::dmat3(1.0);
  double off = std::abs(T_world_rest[0][3]) + std::abs(T_world_rest[1][3]) + std::abs(T_world_rest[2][3]) +
               std::abs(T_world_rest[3][3] - 1);
  for (int i = 0; i < 3; ++i)
    off += std::abs(square[i].x) + std::abs(square[i].y) + std::abs(square[i].z);
  const Vec3 centre = transform_point(T_world_rest, table.centres[solid]);
  if (!(off < 1e-6) || !(glm::determinant(R) > 0) || !finite(centre)) {
    throw bad_usage(fmt::format("pose of solid {}: not a rigid motion (a rotation and a shift)", solid));
  }
  // The shader turns the world's axes into the solid's.
  const glm::dquat q =
      R == glm::dmat3(1.0) ? glm::dquat(1, 0, 0, 0) : glm::conjugate(glm::normalize(glm::quat_cast(R)));
  shader::SolidRecord& record = table.solids[solid];
  const auto f = [](double v) { return static_cast<float>(v); };
  record.centre = {f(centre.x), f(centre.y), f(centre.z), f(q.x)};
  record.low.w = f(q.y);
  record.high.w = f(q.z);
  record.cells_per_metre.w = f(q.w);
}

Box touchable_box(const PlaneTable& table) {
  constexpr double hair = 1e-4;
  Box box;
  for (const shader::SolidRecord& record : table.solids) {
    const glm::dquat q(record.cells_per_metre.w, -record.centre.w, -record.low.w, -record.high.w);
    const Vec3 centre(record.centre.x, record.centre.y, record.centre.z);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at((corner & 1) != 0 ? record.high.x : record.low.x, (corner & 2) != 0 ? record.high.y : record.low.y,
                    (corner & 4) != 0 ? record.high.z : record.low.z);
      box.add(centre + q * at - hair);
      box.add(centre + q * at + hair);
    }
  }
  return box;
}

}  // namespace palpa::touch
