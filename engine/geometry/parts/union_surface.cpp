// Each face is a convex polygon; removing a convex region from it leaves convex polygons. For every other part, two
// regions are removed: the part itself, and the part moved back by the seam against the face's normal. In the second
// region, a step of a seam's width off the face ends inside the part.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "geometry/mesh/nearest.hpp"
#include "geometry/parts/parts.hpp"

namespace palpa::geometry {
namespace {

using Polygon = std::vector<Vec3>;

/// Puts the part of `polygon` where dot(normal, x) < offset into `inside`, the rest into `outside`. Corners within
/// `snap` of the plane count as on it, so that no slivers are cut off.
void split(const Polygon& polygon, const Vec3& normal, double offset, double snap, Polygon& inside, Polygon& outside) {
  inside.clear();
  outside.clear();
  const std::size_t count = polygon.size();
  const auto height = [&](const Vec3& p) {
    const double h = glm::dot(normal, p) - offset;
    return std::abs(h) <= snap ? 0.0 : h;
  };
  double here = height(polygon[0]);
  double lowest = here, highest = here;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % count];
    const double there = height(q);
    lowest = std::min(lowest, there);
    highest = std::max(highest, there);
    if (here <= 0) inside.push_back(p);
    if (here >= 0) outside.push_back(p);
    if ((here < 0 && there > 0) || (here > 0 && there < 0)) {
      const Vec3 cut = p + (q - p) * (here / (here - there));
      inside.push_back(cut);
      outside.push_back(cut);
    }
    here = there;
  }
  if (!(lowest < 0)) inside.clear();
  if (!(highest > 0)) outside.clear();
  if (inside.empty() && outside.empty()) outside = polygon;  // in the plane, so not below it
}

/// A convex region as half-spaces dot(normal, x) < offset.
struct Region {
  const Part* part;
  std::vector<double> offsets;
};

bool meets(const Region& region, const Polygon& polygon, double snap, Polygon& rest, Polygon& scratch_in,
           Polygon& scratch_out, std::uint64_t& cuts) {
  rest = polygon;
  for (std::size_t k = 0; k < region.offsets.size(); ++k) {
    split(rest, region.part->planes[k].normal, region.offsets[k], snap, scratch_in, scratch_out);
    ++cuts;
    if (scratch_in.size() < 3) return false;
    rest.swap(scratch_in);
  }
  return true;
}

class Builder {
 public:
  explicit Builder(const Parts& parts) : parts_(parts) {
    double size = 0;
    for (const Part& part : parts.parts)
      size = std::max(size, glm::distance(part.bounds.low, part.bounds.high));
    snap_ = 1e-10 * size;
    coincident_ = 1e-9 * size;
    seam_ = std::max(parts.seam_m, smallest_seam(parts.parts));
  }

  UnionSurface run() {
    std::uint64_t triangles = 0;
    for (const Part& part : parts_.parts)
      triangles += part.mesh.triangles.size();
    most_ = most_cuts(triangles);
    Activity work("finding their common surface", parts_.parts.size());
    for (std::uint32_t i = 0; i < parts_.parts.size(); ++i) {
      add_part(i);
      work.advance();
    }
    return std::move(surface_);
  }

 private:
  void add_part(std::uint32_t self) {
    const Part& part = parts_.parts[self];
    const std::atomic<bool>* const stop = cancel_flag();
    std::vector<std::uint32_t> near;
    for (std::uint32_t j = 0; j < parts_.parts.size(); ++j) {
      if (j != self && part.bounds.overlaps(parts_.parts[j].bounds, seam_)) near.push_back(j);
    }
    for (std::uint32_t t = 0; t < part.mesh.triangles.size(); ++t) {
      stop_if_cancelled(stop);
      const glm::uvec3& corners = part.mesh.triangles[t];
      Polygon face;
      Box box;
      for (int k = 0; k < 3; ++k) {
        face.push_back(part.mesh.positions[corners[k]]);
        box.add(face.back());
      }
      const std::uint32_t plane = part.plane_of_triangle[t];
      pieces_.clear();
      pieces_.push_back(std::move(face));
      for (const std::uint32_t j : near) {
        if (pieces_.empty()) break;
        if (!box.overlaps(parts_.parts[j].bounds, seam_)) continue;
        take_out(j, j < self, part.planes[plane].normal);
      }
      for (const Polygon& piece : pieces_)
        add_triangles(piece, self, plane);
    }
  }

  void take_out(std::uint32_t other, bool earlier, const Vec3& normal) {
    const Part& part = parts_.parts[other];
    Region inner{&part, {}}, across{&part, {}};
    for (const Plane& plane : part.planes) {
      inner.offsets.push_back(plane.offset + (earlier ? coincident_ : -coincident_));
      across.offsets.push_back(plane.offset - seam_ * glm::dot(normal, plane.normal));
    }
    take_out(inner);
    take_out(across);
  }

  void take_out(const Region& region) {
    if (cuts_ > most_) {
      throw failure(
          fmt::format("its {} convex parts overlap so much that their common surface takes more than {} cuts; "
                      "leave out those that lie within others, or give --internal-faces keep",
                      parts_.parts.size(), most_));
    }
    left_.clear();
    for (Polygon& piece : pieces_) {
      // Kept whole if nothing is removed, so that faces are not cut along planes that only matter elsewhere.
      if (!meets(region, piece, snap_, rest_, inside_, outside_, cuts_)) {
        left_.push_back(std::move(piece));
        continue;
      }
      rest_.swap(piece);
      for (std::size_t k = 0; k < region.offsets.size(); ++k) {
        split(rest_, region.part->planes[k].normal, region.offsets[k], snap_, inside_, outside_);
        if (outside_.size() >= 3) left_.push_back(outside_);
        rest_.swap(inside_);
        if (rest_.size() < 3) break;
      }
    }
    pieces_.swap(left_);
  }

  void add_triangles(const Polygon& polygon, std::uint32_t part, std::uint32_t plane) {
    auto& [mesh, faces] = surface_;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), polygon.begin(), polygon.end());
    for (std::uint32_t k = 1; k + 1 < polygon.size(); ++k) {
      const Vec3 &a = polygon[0], &b = polygon[k], &c = polygon[k + 1];
      if (!(glm::length(glm::cross(b - a, c - a)) > snap_ * snap_)) continue;
      mesh.triangles.emplace_back(first, first + k, first + k + 1);
      faces.push_back({part, plane});
    }
  }

  const Parts& parts_;
  double snap_ = 0, coincident_ = 0, seam_ = 0;
  std::vector<Polygon> pieces_, left_;
  Polygon rest_, inside_, outside_;
  std::uint64_t cuts_ = 0, most_ = 0;
  UnionSurface surface_;
};

}  // namespace

UnionSurface union_surface(const Parts& parts) {
  return Builder(parts).run();
}

double depth(const Parts& parts, const UnionSurface& surface, const Vec3& point) {
  const bool inside =
      std::any_of(parts.parts.begin(), parts.parts.end(), [&](const Part& part) { return depth(part, point) > 0; });
  if (!inside) return 0;
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vec3>& at = surface.mesh.positions;
  for (const glm::uvec3& t : surface.mesh.triangles)
    least = std::min(least, glm::distance(closest_on_triangle(at[t[0]], at[t[1]], at[t[2]], point), point));
  return least;
}

}  // namespace palpa::geometry
