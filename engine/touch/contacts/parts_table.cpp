#include "touch/contacts/parts_table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "geometry/mesh/nearest.hpp"
#include "shaders/touch/contacts/parts_depth.h"
#include "touch/contacts/plane_cells.hpp"

namespace palpa::touch {
namespace {

using geometry::InternalFaces;

/// Lists up to this length are not refined further.
constexpr std::size_t few_triangles = 3;

std::uint32_t cells_per_axis(std::size_t planes) {
  if (planes <= 128) return 8;
  return planes <= 1024 ? 16 : 32;
}

struct LocalPart {
  std::vector<LocalPlane> planes;
};
struct LocalTriangle {
  std::array<Vec3, 3> corners;
  LocalPlane plane;
  Box box;
};

/// A part that reaches into a cell, with those of its planes that can be the nearest in the cell.
struct Candidate {
  std::uint32_t part;
  std::vector<std::uint32_t> planes;
};

std::uint32_t bits(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

shader::uvec4 to_word(const LocalPlane& plane) {
  return {bits(plane.normal.x), bits(plane.normal.y), bits(plane.normal.z), bits(plane.offset)};
}

void add_triangle(std::vector<shader::uvec4>& words, const LocalTriangle& t) {
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 from(t.corners[k]), to(t.corners[(k + 1) % 3]);
    const Vec3 side = Vec3(to) - Vec3(from);
    const double square = glm::dot(side, side);
    // Below this limit, the side is a point in single precision.
    const float scale = square > 1e-30 ? static_cast<float>(1 / square) : 0.0F;
    words.push_back({bits(from.x), bits(from.y), bits(from.z), std::bit_cast<std::uint32_t>(scale)});
  }
  words.push_back(to_word(t.plane));
}

/// Refines a solid's box as an octree whose leaves fill ranges of a flat grid.
class Grid {
 public:
  /// `parts` and `triangles` must outlive it. `triangles` are empty if only each part's planes are used.
  Grid(const std::vector<LocalPart>& parts, const std::vector<LocalTriangle>& triangles, const PartsGrid& grid,
       InternalFaces faces, double tolerance, std::vector<shader::uvec4>& words)
      : parts_(parts),
        triangles_(triangles),
        keep_(faces == InternalFaces::keep),
        low_(grid.low),
        size_((Vec3(grid.high) - Vec3(grid.low)) / static_cast<double>(grid.cells_per_axis)),
        per_axis_(grid.cells_per_axis),
        first_cell_(grid.base + shader::parts_header_words),
        tolerance_(tolerance),
        words_(words) {
    // The error bound of float arithmetic: a few roundings at the size of the box.
    const Vec3 extent = size_ * static_cast<double>(per_axis_);
    margin_ = 1e-6 * (extent.x + extent.y + extent.z);
    std::size_t planes = 0;
    for (const LocalPart& part : parts)
      planes += part.planes.size();
    most_ = most_looks(planes + triangles.size());
  }

  void build() {
    std::vector<Candidate> all(parts_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      all[i].part = i;
      all[i].planes.resize(parts_[i].planes.size());
      for (std::uint32_t m = 0; m < all[i].planes.size(); ++m)
        all[i].planes[m] = m;
    }
    std::vector<std::uint32_t> surface(triangles_.size());
    for (std::uint32_t i = 0; i < surface.size(); ++i)
      surface[i] = i;
    refine(glm::uvec3(0), per_axis_, all, surface);
  }

 private:
  struct Cell {
    Vec3 centre, half;
  };

  void refine(const glm::uvec3& first, std::uint32_t width, const std::vector<Candidate>& inherited,
              const std::vector<std::uint32_t>& surface) {
    for (const Candidate& candidate : inherited)
      looked_at_ += candidate.planes.size();
    looked_at_ += surface.size();
    if (looked_at_ > most_) {
      throw failure(
          fmt::format("its {} convex parts overlap so much that finding the near ones takes more than {} looks at "
                      "their planes and faces; leave out those that lie within others",
                      parts_.size(), most_));
    }
    // The margin of a hundredth of a cell covers points that rounding moves across a cell's side.
    const Cell cell{low_ + size_ * (Vec3(first) + Vec3(0.5 * width)), size_ * (0.5 * width + 0.01)};
    std::vector<Candidate> here;
    bool inside = false;
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : inherited) {
      if (inside && !keep_) break;
      add_candidate(cell, candidate, here, inside, least);
    }
    if (inside && !keep_) here = {{here.back().part, {}}};
    std::vector<std::uint32_t> near;
    if (!here.empty() && !keep_) near = nearest_triangles(cell, surface, least);
    const bool worth = keep_ || near.size() > few_triangles || !inside;
    if (!here.empty() && width > 1 && least < refined_depth && worth) {
      const std::uint32_t child = width / 2;
      for (std::uint32_t c = 0; c < 8; ++c)
        refine(first + glm::uvec3(c & 1U, c >> 1 & 1U, c >> 2) * child, child, here, near);
      return;
    }
    write(first, width, here, near, std::max(0.0, least));
  }

  /// Adds the part with its relevant planes, if the cell reaches into it. Lowers `least` to the least depth below its
  /// planes that a point of the cell inside the part can have (keep only).
  void add_candidate(const Cell& cell, const Candidate& candidate, std::vector<Candidate>& here, bool& inside,
                     double& least) const {
    const std::vector<LocalPlane>& planes = parts_[candidate.part].planes;
    double deepest = std::numeric_limits<double>::infinity(), shallowest = deepest, nearest_depth = deepest;
    std::uint32_t nearest = 0;
    for (const std::uint32_t m : candidate.planes) {
      const double depth = planes[m].offset - glm::dot(planes[m].normal, cell.centre);
      const double reach = half_width(planes[m].normal, cell.half);
      deepest = std::min(deepest, depth + reach);
      shallowest = std::min(shallowest, depth - reach);
      if (depth < nearest_depth) {
        nearest_depth = depth;
        nearest = m;
      }
    }
    // No planes: the whole cell is inside the part, and so are all cells within it. Otherwise, all that follow would be
    // lost.
    if (candidate.planes.empty()) shallowest = deepest = std::numeric_limits<double>::infinity();
    if (deepest + margin_ <= -tolerance_) return;
    Candidate kept{candidate.part, {}};
    for (const std::uint32_t m : candidate.planes) {
      const double behind = planes[m].offset - glm::dot(planes[m].normal, cell.centre) - nearest_depth;
      if (behind <= half_width(planes[m].normal - planes[nearest].normal, cell.half) + margin_)
        kept.planes.push_back(m);
    }
    here.push_back(std::move(kept));
    inside = inside || shallowest - margin_ > 0;
    if (keep_) least = std::min(least, shallowest - margin_);
  }

  /// The triangles that can be the nearest to some point of the cell. Sets `least` to a lower bound of the depth in the
  /// cell.
  std::vector<std::uint32_t> nearest_triangles(const Cell& cell, const std::vector<std::uint32_t>& surface,
                                               double& least) {
    if (surface.empty()) return {};
    const double radius = glm::length(cell.half);
    distance_.clear();
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t nearest_triangle = 0;
    for (const std::uint32_t t : surface) {
      const LocalTriangle& triangle = triangles_[t];
      const Vec3 out = glm::max(glm::max(triangle.box.low - cell.centre, cell.centre - triangle.box.high), Vec3(0));
      const double above = std::abs(triangle.plane.offset - glm::dot(triangle.plane.normal, cell.centre));
      // A lower bound is sufficient for triangles that are not the nearest.
      distance_.push_back(std::max(glm::length(out), above));
      if (distance_.back() >= nearest) continue;
      distance_.back() = glm::distance(closest(t, cell.centre), cell.centre);
      if (distance_.back() < nearest) {
        nearest = distance_.back();
        nearest_triangle = t;
      }
    }
    // The distance to a triangle is convex, so its maximum over a cell is at a corner.
    std::array<Vec3, 8> corners{};
    double farthest = 0;
    for (std::uint32_t c = 0; c < 8; ++c) {
      corners[c] = cell.centre + Vec3(c & 1U ? 1 : -1, c & 2U ? 1 : -1, c & 4U ? 1 : -1) * cell.half;
      farthest = std::max(farthest, glm::distance(closest(nearest_triangle, corners[c]), corners[c]));
    }
    std::vector<std::uint32_t> near;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const LocalTriangle& t = triangles_[surface[i]];
      const Vec3 gap =
          glm::max(glm::max(t.box.low - (cell.centre + cell.half), (cell.centre - cell.half) - t.box.high), Vec3(0));
      const double above = std::abs(t.plane.offset - glm::dot(t.plane.normal, cell.centre));
      const double bound =
          std::max({distance_[i] - radius, glm::length(gap), above - half_width(t.plane.normal, cell.half)});
      if (bound <= farthest + margin_) near.push_back(surface[i]);
    }
    least = nearest - radius - margin_;
    if (near.size() > few_triangles) drop_outdone(corners, closest(nearest_triangle, cell.centre), farthest, near);
    return near;
  }

  /// Leaves out triangles that are farther than a point q of the surface everywhere in the cell. The squared distance
  /// to a triangle minus the squared distance to q is a minimum of linear functions, so its minimum is at one of the
  /// cell's corners.
  void drop_outdone(const std::array<Vec3, 8>& corners, const Vec3& below_centre, double farthest,
                    std::vector<std::uint32_t>& near) {
    squares_.resize(near.size());
    std::array<double, 8> best{};
    std::array<Vec3, 9> candidates{};
    best.fill(std::numeric_limits<double>::infinity());
    candidates[8] = below_centre;
    for (std::size_t i = 0; i < near.size(); ++i) {
      for (std::size_t c = 0; c < 8; ++c) {
        const Vec3 at = closest(near[i], corners[c]);
        const double square = glm::dot(at - corners[c], at - corners[c]);
        squares_[i][c] = square;
        if (square < best[c]) {
          best[c] = square;
          candidates[c] = at;
        }
      }
    }
    const double slack = margin_ * (4 * farthest + margin_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      const bool outdone = std::any_of(candidates.begin(), candidates.end(), [&](const Vec3& q) {
        for (std::size_t c = 0; c < 8; ++c) {
          if (squares_[i][c] <= glm::dot(q - corners[c], q - corners[c]) + slack) return false;
        }
        return true;
      });
      if (!outdone) near[kept++] = near[i];
    }
    near.resize(kept);
  }

  Vec3 closest(std::uint32_t triangle, const Vec3& point) const {
    const auto& [a, b, c] = triangles_[triangle].corners;
    return geometry::closest_on_triangle(a, b, c, point);
  }

  void write(const glm::uvec3& first, std::uint32_t width, const std::vector<Candidate>& here,
             const std::vector<std::uint32_t>& near, double least) {
    const auto place = [&] { return static_cast<std::uint32_t>(words_.size()); };
    std::vector<shader::uvec4> entries;
    for (const Candidate& candidate : here) {
      entries.push_back({place(), static_cast<std::uint32_t>(candidate.planes.size()), 0, 0});
      for (const std::uint32_t m : candidate.planes)
        words_.push_back(to_word(parts_[candidate.part].planes[m]));
    }
    shader::uvec4 lists{place(), static_cast<std::uint32_t>(here.size()), 0, static_cast<std::uint32_t>(near.size())};
    words_.insert(words_.end(), entries.begin(), entries.end());
    lists.z = place();
    for (const std::uint32_t t : near)
      add_triangle(words_, triangles_[t]);
    const shader::uvec4 bound{std::bit_cast<std::uint32_t>(rounded_down(least)), 0, 0, 0};
    for (std::uint32_t z = first.z; z < first.z + width; ++z) {
      for (std::uint32_t y = first.y; y < first.y + width; ++y) {
        for (std::uint32_t x = first.x; x < first.x + width; ++x) {
          const std::size_t cell = (std::size_t{z} * per_axis_ + y) * per_axis_ + x;
          words_[first_cell_ + shader::parts_cell_words * cell] = lists;
          words_[first_cell_ + shader::parts_cell_words * cell + 1] = bound;
        }
      }
    }
  }

  const std::vector<LocalPart>& parts_;
  const std::vector<LocalTriangle>& triangles_;
  bool keep_;
  Vec3 low_, size_;
  std::uint32_t per_axis_;
  std::uint32_t first_cell_;
  // distance by which a point may be outside two parts at once and still count as inside their union
  double tolerance_;
  std::vector<shader::uvec4>& words_;
  double margin_ = 0;
  std::uint64_t looked_at_ = 0, most_ = 0;
  std::vector<double> distance_;
  std::vector<std::array<double, 8>> squares_;
};

}  // namespace

PartsGrid add_parts(std::vector<shader::uvec4>& words, const geometry::Parts& parts, InternalFaces faces) {
  Box box;
  bool usable = !parts.parts.empty();
  for (const geometry::Part& part : parts.parts) {
    usable = usable && !part.planes.empty() && !part.bounds.empty() && is_finite(part.bounds.low) &&
             is_finite(part.bounds.high);
    for (const geometry::Plane& plane : part.planes)
      usable = usable && is_finite(plane.normal) && std::isfinite(plane.offset);
    box.add(part.bounds.low);
    box.add(part.bounds.high);
  }
  if (!usable) throw bad_usage("a solid's convex part has no planes or no finite box");

  PartsGrid grid;
  grid.centre = glm::vec3(box.centre());  // rounded as in the shader
  const Vec3 centre(grid.centre), extent = box.high - box.low;
  const double margin = 1e-6 * (extent.x + extent.y + extent.z) + 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    grid.low[axis] = rounded_down(box.low[axis] - centre[axis] - margin);
    grid.high[axis] = rounded_up(box.high[axis] - centre[axis] + margin);
  }

  std::vector<LocalPart> local(parts.parts.size());
  std::size_t planes = 0;
  for (std::size_t i = 0; i < local.size(); ++i) {
    for (const geometry::Plane& plane : parts.parts[i].planes)
      local[i].planes.push_back({plane.normal, plane.offset - glm::dot(plane.normal, centre)});
    planes += local[i].planes.size();
  }
  std::vector<LocalTriangle> triangles;
  if (faces == InternalFaces::drop) {
    const geometry::UnionSurface surface = geometry::union_surface(parts);
    for (std::size_t t = 0; t < surface.faces.size(); ++t) {
      const auto corner = [&](int i) { return surface.mesh.positions[surface.mesh.triangles[t][i]] - centre; };
      const auto& [part, plane] = surface.faces[t];
      LocalTriangle mine{{corner(0), corner(1), corner(2)}, local[part].planes[plane], {}};
      for (const Vec3& at : mine.corners)
        mine.box.add(at);
      triangles.push_back(mine);
    }
  }
  grid.cells_per_axis = cells_per_axis(planes);
  grid.cells_per_metre = static_cast<float>(grid.cells_per_axis) / (grid.high - grid.low);
  grid.base = static_cast<std::uint32_t>(words.size());
  const double tolerance = geometry::smallest_seam(parts.parts) / 2;
  const std::size_t cells = std::size_t{grid.cells_per_axis} * grid.cells_per_axis * grid.cells_per_axis;
  words.resize(words.size() + shader::parts_header_words + shader::parts_cell_words * cells);
  words[grid.base] = {bits(tolerance), faces == InternalFaces::keep ? 1U : 0U, 0, 0};
  const Activity work("filling the grid of its parts");
  Grid(local, triangles, grid, faces, tolerance, words).build();
  return grid;
}

}  // namespace palpa::touch
