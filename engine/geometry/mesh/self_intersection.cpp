#include "geometry/mesh/self_intersection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/predicates.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

using Triangle = std::array<Vec3, 3>;

Triangle corners(const Mesh& mesh, std::uint32_t t) {
  const glm::uvec3& v = mesh.triangles[t];
  return {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
}

Vec2 dropped(const Vec3& p, int axis) {
  return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  return geometry::orient2d(dropped(a, axis), dropped(b, axis), dropped(c, axis));
}

// The axis along which a triangle may be projected without becoming a line; -1 if it has no area.
int flattening_axis(const Triangle& t) {
  const Vec3 n = glm::abs(glm::cross(t[1] - t[0], t[2] - t[0]));
  const int best = n.x >= n.y && n.x >= n.z ? 0 : (n.y >= n.z ? 1 : 2);
  for (int i = 0; i < 3; ++i) {
    const int axis = (best + i) % 3;
    if (orient2d(t[0], t[1], t[2], axis) != 0) return axis;
  }
  return -1;
}

bool between(const Vec2& a, const Vec2& b, const Vec2& p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = geometry::orient2d(a, b, c), abd = geometry::orient2d(a, b, d);
  const int cda = geometry::orient2d(c, d, a), cdb = geometry::orient2d(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

// For a segment in the triangle's plane.
bool flat_meet(const Vec3& p, const Vec3& q, const Triangle& t) {
  const int axis = flattening_axis(t);
  if (axis < 0) return false;
  const int turn = orient2d(t[0], t[1], t[2], axis);
  for (const Vec3& end : {p, q}) {
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i)
      inside = inside && orient2d(t[i], t[(i + 1) % 3], end, axis) * turn >= 0;
    if (inside) return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (segments_meet(dropped(p, axis), dropped(q, axis), dropped(t[i], axis), dropped(t[(i + 1) % 3], axis)))
      return true;
  }
  return false;
}

// A segment against a triangle, both closed.
bool segment_meets(const Vec3& p, const Vec3& q, int side_p, int side_q, const Triangle& t) {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return flat_meet(p, q, t);
  const int a = orient3d(p, q, t[0], t[1]), b = orient3d(p, q, t[1], t[2]);
  if (a * b < 0) return false;
  const int c = orient3d(p, q, t[2], t[0]);
  return a * c >= 0 && b * c >= 0;
}

struct Sides {
  std::array<int, 3> of;
  bool all_on_one() const { return (of[0] > 0 && of[1] > 0 && of[2] > 0) || (of[0] < 0 && of[1] < 0 && of[2] < 0); }
};

Sides sides_of(const Triangle& plane, const Triangle& t) {
  return {{orient3d(plane[0], plane[1], plane[2], t[0]), orient3d(plane[0], plane[1], plane[2], t[1]),
           orient3d(plane[0], plane[1], plane[2], t[2])}};
}

bool apart_meet(const Triangle& a, const Triangle& b) {
  const Sides of_b = sides_of(a, b);
  if (of_b.all_on_one()) return false;
  const Sides of_a = sides_of(b, a);
  if (of_a.all_on_one()) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if (segment_meets(b[i], b[k], of_b.of[i], of_b.of[k], a) || segment_meets(a[i], a[k], of_a.of[i], of_a.of[k], b))
      return true;
  }
  return false;
}

// a[0] and b[0] are the same vertex. The triangles meet elsewhere only if a side opposite to it meets the other
// triangle.
bool at_vertex_meet(const Triangle& a, const Triangle& b) {
  const int b1 = orient3d(a[0], a[1], a[2], b[1]), b2 = orient3d(a[0], a[1], a[2], b[2]);
  if (b1 * b2 > 0) return false;
  const int a1 = orient3d(b[0], b[1], b[2], a[1]), a2 = orient3d(b[0], b[1], b[2], a[2]);
  if (a1 * a2 > 0) return false;
  return segment_meets(b[1], b[2], b1, b2, a) || segment_meets(a[1], a[2], a1, a2, b);
}

// a and b share their first two vertices.
bool at_edge_meet(const Triangle& a, const Triangle& b) {
  if (orient3d(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = flattening_axis(a);
  return axis >= 0 && orient2d(a[0], a[1], a[2], axis) * orient2d(b[0], b[1], b[2], axis) > 0;
}

bool has_area(const Mesh& mesh, std::uint32_t t) {
  const Vec3 n = area_vector(mesh, t);
  const Triangle c = corners(mesh, t);
  const double size = glm::length(c[1] - c[0]) * glm::length(c[2] - c[0]);
  return glm::length(n) > 1e-12 * size || flattening_axis(c) >= 0;
}

}  // namespace

bool triangles_meet(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  const glm::uvec3 &va = mesh.triangles[a], &vb = mesh.triangles[b];
  int shared = 0, other_a = 0, other_b = 0, same_a = 0, same_b = 0;
  for (int i = 0; i < 3; ++i) {
    bool found = false;
    for (int k = 0; k < 3; ++k) {
      if (va[i] != vb[k]) continue;
      found = true;
      same_a = i;
      same_b = k;
    }
    if (found) ++shared;
    if (!found) other_a = i;
  }
  for (int k = 0; k < 3; ++k) {
    if (vb[k] != va[0] && vb[k] != va[1] && vb[k] != va[2]) other_b = k;
  }
  const Triangle ta = corners(mesh, a), tb = corners(mesh, b);
  const auto turned = [](const Triangle& t, int first) {
    const auto i = static_cast<std::size_t>(first);
    return Triangle{t[i], t[(i + 1) % 3], t[(i + 2) % 3]};
  };
  if (shared == 0) return apart_meet(ta, tb);
  if (shared == 1) return at_vertex_meet(turned(ta, same_a), turned(tb, same_b));
  if (shared == 3) return true;
  // Puts the shared edge first, in the same direction in both.
  Triangle first = turned(ta, (other_a + 1) % 3), second = turned(tb, (other_b + 1) % 3);
  if (second[0] != first[0]) std::swap(second[0], second[1]);
  return at_edge_meet(first, second);
}

std::optional<Crossing> find_self_intersection(const Mesh& mesh, const Bvh& bvh, std::uint64_t most) {
  const std::span<const Bvh::Node> nodes = bvh.nodes();
  const std::span<const std::uint32_t> order = bvh.order();
  std::vector<Box> boxes(order.size());
  std::vector<char> skipped(order.size());
  parallel_chunks(order.size(), 8192, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (const Vec3& corner : corners(mesh, order[i]))
        boxes[i].add(corner);
      skipped[i] = has_area(mesh, order[i]) ? 0 : 1;
    }
  });
  constexpr std::size_t chunk = 64;  // small, because a chunk that was begun is processed to its end at any cost
  std::vector<std::optional<Crossing>> found(chunk_count(order.size(), chunk));
  std::vector<std::uint64_t> pairs(found.size(), 0);
  std::atomic<std::uint64_t> all_pairs{0};
  std::atomic<std::size_t> first_found{found.size()};
  Activity work("looking for crossings", found.size());
  // Tests each triangle against the later ones. Chunks before one with a crossing are in progress or done by then.
  parallel_chunks(order.size(), chunk, [&](std::size_t number, std::size_t begin, std::size_t end) {
    if (number > first_found.load() || all_pairs > most) return;
    std::array<std::uint32_t, 64> stack;
    for (std::size_t i = begin; i < end && !found[number] && pairs[number] <= most; ++i) {
      if (skipped[i] != 0) continue;
      std::size_t depth = 0;
      stack[depth++] = 0;
      while (depth > 0 && !found[number]) {
        const std::uint32_t index = stack[--depth];
        const Bvh::Node& node = nodes[index];
        if (node.end <= i + 1 || !node.box.overlaps(boxes[i])) continue;
        if (node.second != 0) {
          stack[depth++] = node.second;
          stack[depth++] = index + 1;
          continue;
        }
        for (std::size_t k = std::max<std::size_t>(node.begin, i + 1); k < node.end; ++k) {
          if (skipped[k] != 0 || !boxes[i].overlaps(boxes[k])) continue;
          ++pairs[number];
          if (!triangles_meet(mesh, order[i], order[k])) continue;
          Box both{glm::max(boxes[i].low, boxes[k].low), glm::min(boxes[i].high, boxes[k].high)};
          found[number] = {{std::min(order[i], order[k]), std::max(order[i], order[k])}, both.centre()};
          std::size_t expected = first_found.load();
          while (number < expected && !first_found.compare_exchange_weak(expected, number)) {
          }
          break;
        }
      }
    }
    all_pairs += pairs[number];
    work.advance();
  });
  // In order, so that the result is that of one thread. Chunks begin in ascending order, so those that were not begun
  // come after the one that exceeded the limit.
  std::uint64_t looked_at = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    looked_at += pairs[i];
    if (looked_at > most) {
      throw failure(
          fmt::format("more than {} pairs of its {} triangles have boxes that overlap, too many to look for "
                      "crossings; turn the mesh so that its long faces run along an axis, divide them, or make "
                      "several meshes of it",
                      most, order.size()));
    }
    if (found[i]) return found[i];
  }
  return std::nullopt;
}

}  // namespace palpa::geometry
