#include "touch/contacts/prepared_solids.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/contacts/parts_depth.h"
#include "shaders/touch/contacts/surface.h"
#include "touch/contacts/parts_table.hpp"
#include "touch/contacts/plane_cells.hpp"

namespace palpa::touch {
namespace {

/// Iterations for a solid whose box does not contain the point: a software device also runs the head of a loop that is
/// not taken.
constexpr std::uint64_t for_any_planes = 2, for_any_surface = 4, for_any_parts = 7;
constexpr std::size_t boxes_that_meet = 16;

/// Covers only the cells that are looked up: plane_cell_depth() of contacts_math.h skips those that are too deep.
std::uint64_t longest_of_planes(const PreparedSolids& solids, const shader::SolidRecord& record, float delta,
                                bool deep) {
  const std::size_t cells = std::size_t{record.cells_per_axis} * record.cells_per_axis * record.cells_per_axis;
  std::uint64_t longest = 0;
  for (const shader::PlaneCell& cell : std::span(solids.cells).subspan(record.first_cell, cells)) {
    if (deep || cell.shallowest < delta) longest = std::max<std::uint64_t>(longest, cell.count);
  }
  return longest;
}

std::uint64_t longest_of_parts(const PreparedSolids& solids, const shader::SolidRecord& record) {
  const std::size_t cells = std::size_t{record.cells_per_axis} * record.cells_per_axis * record.cells_per_axis;
  std::uint64_t entries = 0, planes = 0, triangles = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    const shader::uvec4& lists =
        solids.parts[record.first_cell + shader::parts_header_words + c * shader::parts_cell_words];
    entries = std::max<std::uint64_t>(entries, lists.y);
    triangles = std::max<std::uint64_t>(triangles, lists.w);
    for (const shader::uvec4& entry : std::span(solids.parts).subspan(lists.x, lists.y))
      planes = std::max<std::uint64_t>(planes, entry.y);
  }
  return entries * (planes + 2) + triangles;
}

/// An upper bound of the iterations that the loops of contacts_walk.glsl take for one point with these parameters,
/// whichever points its neighbours in the group look up. It counts some iterations for every solid, plus the longest
/// lists of the sixteen solids with the longest lists, because the boxes of more than sixteen solids hardly ever meet
/// in one place. Looks at every cell of every solid.
std::uint32_t contact_iterations(const PreparedSolids& solids, const FingerOptions& parameters) {
  std::uint64_t for_any = for_any_planes;
  std::vector<std::uint64_t> longest;
  longest.reserve(solids.records.size());
  for (std::size_t s = 0; s < solids.records.size(); ++s) {
    const shader::SolidRecord& record = solids.records[s];
    if (record.asked_by == shader::asked_by_parts) {
      for_any = std::max(for_any, for_any_parts);
      longest.push_back(longest_of_parts(solids, record));
    } else if (record.asked_by == shader::asked_by_surface) {
      for_any = std::max(for_any, for_any_surface);
      longest.push_back(std::uint64_t{solids.surfaces[s].longest} + shader::surface_most_levels);
    } else {
      longest.push_back(longest_of_planes(solids, record,
                                          static_cast<float>(solids.delta_m(static_cast<std::uint32_t>(s), parameters)),
                                          parameters.wants_deep()));
    }
  }
  const std::size_t some = std::min(longest.size(), boxes_that_meet);
  std::partial_sort(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(some), longest.end(),
                    std::greater<>());
  const std::uint64_t iterations = std::accumulate(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(some),
                                                   for_any * solids.records.size() + 1);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(iterations, std::numeric_limits<std::uint32_t>::max()));
}

/// A solid with more planes than this is looked up by its surface, if it has a mesh.
constexpr std::size_t most_planes = 4096;
/// Limit of all lists of planes of a scene together, at 16 bytes per entry. A solid that would exceed it keeps one list
/// of all its planes.
constexpr std::size_t most_listed = std::size_t{3} << 20;

shader::vec4 to_float(const LocalPlane& p) {
  return {static_cast<float>(p.normal.x), static_cast<float>(p.normal.y), static_cast<float>(p.normal.z),
          static_cast<float>(p.offset)};
}

shader::SolidRecord at_rest() {
  shader::SolidRecord record{};
  record.turn = {0, 0, 0, 1};
  return record;
}

void add_convex(PreparedSolids& table, std::size_t& listed, const geometry::Solid& solid,
                const std::vector<LocalPlane>& planes) {
  const Vec3 extent = solid.bounds.high - solid.bounds.low;
  const double margin = 1e-6 * (extent.x + extent.y + extent.z) + 1e-9;
  const Vec3 centre(glm::vec3(solid.bounds.centre()));  // rounded as in the shader
  const Vec3 low = solid.bounds.low - centre - margin, high = solid.bounds.high - centre + margin;

  shader::SolidRecord record = at_rest();
  record.centre = {static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z), 0};
  record.low = {rounded_down(low.x), rounded_down(low.y), rounded_down(low.z), 0};
  record.high = {rounded_up(high.x), rounded_up(high.y), rounded_up(high.z), 0};
  record.delta = static_cast<float>(solid.haptics.delta_m.value_or(0));
  record.first_cell = static_cast<std::uint32_t>(table.cells.size());
  const PlaneCells made = make_plane_cells(planes, low, high, most_listed - std::min(most_listed, listed));
  record.cells_per_axis = made.per_axis;
  const Vec3 density = static_cast<double>(record.cells_per_axis) / (high - low);
  record.cells_per_metre = {static_cast<float>(density.x), static_cast<float>(density.y), static_cast<float>(density.z),
                            0};
  table.records.push_back(record);
  table.centres.push_back(centre);
  const auto base = static_cast<std::uint32_t>(table.planes.size());
  for (shader::PlaneCell cell : made.cells) {
    cell.first += base;
    table.cells.push_back(cell);
  }
  for (const std::uint32_t m : made.list)
    table.planes.push_back(to_float(planes[m]));
  listed += made.list.size();
}

bool asked_by_surface(const geometry::Solid& solid) {
  return !solid.mesh.triangles.empty() && (solid.planes.empty() || solid.planes.size() > most_planes);
}

/// An error with a solid from a file is reported with that file.
template <typename Make>
auto made_of(const geometry::Solid& solid, const Make& make) {
  const Activity work(fmt::format("preparing mesh \"{}\"", printable(solid.name, 60)));
  try {
    return make();
  } catch (const Error& e) {
    if (solid.file.empty()) throw;
    throw bad_input(solid.file, fmt::format("mesh \"{}\": {}", printable(solid.name, 60), e.what()));
  }
}

/// Refuses a file's solid that does not fit the finger gap; check_parameters() handles all others.
void check_size(const geometry::Solid& solid, const shader::SolidRecord& record, const FingerOptions& parameters) {
  const double least = least_finger_gap(record), gap = parameters.finger_gap_m;
  if (solid.file.empty() || !(gap > 0) || gap >= least) return;
  throw bad_input(solid.file,
                  fmt::format("mesh \"{}\" is {:.3g} m long; with a finger gap of {} m a solid has at most {:.3g} m "
                              "(glTF's unit is the metre): scale it, or give --finger-gap {:.3g}m",
                              printable(solid.name, 60), 2 * half_size(record), gap,
                              2 * half_size(record) * gap / least, least * 1.01));
}

/// Limit of all surface grids together, in cells that no triangle requires.
constexpr std::uint32_t most_least_cells = 1U << 18U, fewest_cells = 64;

geometry::SurfaceOptions surface_options(const std::vector<geometry::Solid>& solids, const FingerOptions& parameters) {
  geometry::SurfaceOptions options{.reach_m = parameters.delta_m, .deep = parameters.wants_deep()};
  const auto surfaces = static_cast<std::uint32_t>(std::count_if(solids.begin(), solids.end(), asked_by_surface));
  options.least_cells =
      std::min(options.least_cells, std::max(fewest_cells, most_least_cells / std::max(surfaces, 1U)));
  return options;
}

/// The surfaces that copies may share, by shape and delta.
using SharedSurfaces = std::map<std::pair<const void*, double>, std::uint32_t>;

/// Adds a solid that shares the surface of the one at `first`.
void add_copy(PreparedSolids& table, const std::vector<geometry::Solid>& solids, const geometry::Solid& solid,
              std::uint32_t first) {
  const auto s = static_cast<std::uint32_t>(table.records.size());
  table.records.push_back(table.records[first]);
  table.records[s].delta = static_cast<float>(solid.haptics.delta_m.value_or(0));
  table.centres.push_back(table.centres[first]);
  table.surface_base.push_back(table.surface_base[first]);
  table.surfaces.push_back(table.surfaces[first]);
  table.T_rest_made.push_back(solid.copy.T_world_shape * glm::inverse(solids[first].copy.T_world_shape));
  set_pose(table, s, Transform(1));
}

void add_closed_mesh(PreparedSolids& table, SurfaceBase& next, const geometry::Solid& solid,
                     geometry::SurfaceOptions options) {
  options.reach_m = solid.haptics.delta_m.value_or(options.reach_m);
  geometry::Surface surface = made_of(solid, [&] { return geometry::make_surface(solid.mesh, options); });
  shader::SolidRecord record = at_rest();
  const auto f = [](double v) { return static_cast<float>(v); };
  record.centre = {f(surface.centre.x), f(surface.centre.y), f(surface.centre.z), 0};
  record.low = {f(surface.low.x), f(surface.low.y), f(surface.low.z), 0};
  record.high = {f(surface.high.x), f(surface.high.y), f(surface.high.z), 0};
  const float density = f(1 / surface.cell_m);
  record.cells_per_metre = {density, density, density, 0};
  record.first_cell = next.cells;
  record.cells_per_axis =
      surface.grid.x | surface.grid.y << shader::surface_axis_bits | surface.grid.z << 2 * shader::surface_axis_bits;
  record.delta = f(solid.haptics.delta_m.value_or(0));
  record.asked_by = shader::asked_by_surface;
  table.records.push_back(record);
  table.centres.push_back(surface.centre);
  table.T_rest_made.emplace_back(1);
  table.surface_base.push_back(next);
  if (surface.triangles.size() > shader::surface_most_triangles - next.triangles) {
    const std::string fault =
        fmt::format("the scene's solids have more than {} triangles together: give fewer or coarser ones",
                    shader::surface_most_triangles);
    throw solid.file.empty() ? bad_usage(fault) : bad_input(solid.file, fault);
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

void add_convex_parts(PreparedSolids& table, const geometry::Solid& solid) {
  const PartsGrid grid = made_of(solid, [&] { return add_parts(table.parts, solid.parts, solid.internal_faces); });
  shader::SolidRecord record = at_rest();
  record.centre = {grid.centre.x, grid.centre.y, grid.centre.z, 0};
  record.low = {grid.low.x, grid.low.y, grid.low.z, 0};
  record.high = {grid.high.x, grid.high.y, grid.high.z, 0};
  record.cells_per_metre = {grid.cells_per_metre.x, grid.cells_per_metre.y, grid.cells_per_metre.z, 0};
  record.first_cell = grid.base;
  record.cells_per_axis = grid.cells_per_axis;
  record.delta = static_cast<float>(solid.haptics.delta_m.value_or(0));
  record.asked_by = shader::asked_by_parts;
  table.records.push_back(record);
  table.centres.emplace_back(grid.centre);
}

}  // namespace

std::vector<std::uint32_t> foci_of_solids(const std::vector<geometry::Solid>& solids) {
  std::vector<std::uint32_t> foci;
  foci.reserve(solids.size());
  for (const geometry::Solid& solid : solids) {
    foci.push_back(solid.haptics.foci.value_or(0));
    if (solid.haptics.foci && (foci.back() < 1 || foci.back() > max_foci)) {
      throw bad_usage(fmt::format("solid '{}' asks for {} foci: give 1 to {}", solid.name, foci.back(), max_foci));
    }
  }
  return foci;
}

double half_size(const shader::SolidRecord& solid) {
  return static_cast<double>(
      std::max({solid.high.x, solid.high.y, solid.high.z, -solid.low.x, -solid.low.y, -solid.low.z}));
}

double least_finger_gap(const shader::SolidRecord& solid) {
  return half_size(solid) * std::numbers::sqrt3 /
         (2e-3 * shader::clusters_cell_thousandths * shader::clusters_most_blocks);
}

PreparedSolids prepare_solids(const std::vector<geometry::Solid>& solids, const FingerOptions& parameters) {
  PreparedSolids table;
  if (!solids.empty()) table.file = solids[0].file;
  table.foci_of = foci_of_solids(solids);
  std::vector<std::vector<LocalPlane>> local(solids.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const geometry::Solid& solid = solids[s];
    const bool by_surface = asked_by_parts(solid) || asked_by_surface(solid);
    bool usable = (by_surface || !solid.planes.empty()) && !solid.bounds.empty() && is_finite(solid.bounds.low) &&
                  is_finite(solid.bounds.high);
    const Vec3 centre(glm::vec3(solid.bounds.centre()));
    for (const geometry::Plane& plane : solid.planes) {
      if (by_surface) break;
      local[s].push_back({plane.normal, plane.offset - glm::dot(plane.normal, centre)});
      usable = usable && is_finite(plane.normal) && std::isfinite(plane.offset);
    }
    if (!usable) throw bad_usage(fmt::format("solid '{}' has no planes or no finite box", solid.name));
  }
  std::size_t listed = 0;
  SurfaceBase next;
  SharedSurfaces shared;
  const geometry::SurfaceOptions options = surface_options(solids, parameters);
  for (std::size_t s = 0; s < solids.size(); ++s) {
    if (!asked_by_parts(solids[s]) && asked_by_surface(solids[s])) {
      const std::pair key(solids[s].copy.shape.get(), solids[s].haptics.delta_m.value_or(parameters.delta_m));
      const auto known = key.first != nullptr ? shared.find(key) : shared.end();
      if (known != shared.end()) {
        add_copy(table, solids, solids[s], known->second);
      } else {
        add_closed_mesh(table, next, solids[s], options);
        if (key.first != nullptr) shared.emplace(key, static_cast<std::uint32_t>(s));
      }
      continue;
    }
    if (asked_by_parts(solids[s])) {
      add_convex_parts(table, solids[s]);
    } else {
      add_convex(table, listed, solids[s], local[s]);
    }
    table.T_rest_made.emplace_back(1);
    table.surfaces.emplace_back();
    table.surface_base.push_back(next);
  }
  for (std::size_t s = 0; s < solids.size(); ++s)
    check_size(solids[s], table.records[s], parameters);
  table.made_for = {parameters.delta_m, parameters.wants_deep()};
  table.iterations = contact_iterations(table, parameters);
  return table;
}

PreparedSolids KeptSolids::prepare(const std::vector<geometry::Solid>& solids, const FingerOptions& parameters) {
  std::shared_ptr<const PreparedSolids> known;
  {
    const std::lock_guard lock(mutex_);
    if (last_ && last_->made_for.delta_m == parameters.delta_m && last_->made_for.deep == parameters.wants_deep() &&
        finger_gap_m_ == parameters.finger_gap_m)
      known = last_;
  }
  if (!known) {
    known = std::make_shared<const PreparedSolids>(prepare_solids(solids, parameters));
    const std::lock_guard lock(mutex_);
    last_ = known;
    finger_gap_m_ = parameters.finger_gap_m;
  }
  PreparedSolids prepared = *known;
  prepared.iterations = contact_iterations(prepared, parameters);
  return prepared;
}

void set_pose(PreparedSolids& solids, std::uint32_t solid, const Transform& T_world_rest) {
  if (solid >= solids.records.size()) {
    throw bad_usage(fmt::format("pose of solid {}: the scene has {}", solid, counted(solids.records.size(), "solid")));
  }
  const Transform T_world_made = T_world_rest * solids.T_rest_made[solid];
  const glm::dmat3 R(T_world_made);
  const glm::dmat3 square = glm::transpose(R) * R - glm::dmat3(1.0);
  double off = std::abs(T_world_made[0][3]) + std::abs(T_world_made[1][3]) + std::abs(T_world_made[2][3]) +
               std::abs(T_world_made[3][3] - 1);
  for (int i = 0; i < 3; ++i)
    off += std::abs(square[i].x) + std::abs(square[i].y) + std::abs(square[i].z);
  const Vec3 centre = transform_point(T_world_made, solids.centres[solid]);
  if (!(off < 1e-6) || !(glm::determinant(R) > 0) || !is_finite(centre)) {
    throw bad_usage(fmt::format("pose of solid {}: not a rigid motion (a rotation and a shift)", solid));
  }
  // The rotation from the world's axes to the solid's, for the shader.
  const glm::dquat q =
      R == glm::dmat3(1.0) ? glm::dquat(1, 0, 0, 0) : glm::conjugate(glm::normalize(glm::quat_cast(R)));
  shader::SolidRecord& record = solids.records[solid];
  const auto f = [](double v) { return static_cast<float>(v); };
  record.centre = {f(centre.x), f(centre.y), f(centre.z), 0};
  record.turn = {f(q.x), f(q.y), f(q.z), f(q.w)};
}

Box touchable_box(const PreparedSolids& solids) {
  constexpr double hair = 1e-4;
  Box box;
  for (const shader::SolidRecord& record : solids.records) {
    const glm::dquat q(record.turn.w, -record.turn.x, -record.turn.y, -record.turn.z);
    const Vec3 centre(record.centre.x, record.centre.y, record.centre.z);
    if (glm::any(glm::greaterThan(glm::abs(centre), Vec3(out_of_reach_m)))) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at((corner & 1) != 0 ? record.high.x : record.low.x, (corner & 2) != 0 ? record.high.y : record.low.y,
                    (corner & 4) != 0 ? record.high.z : record.low.z);
      box.add(centre + q * at - hair);
      box.add(centre + q * at + hair);
    }
  }
  if (box.empty()) box.add(Vec3(0));
  return box;
}

}  // namespace palpa::touch
