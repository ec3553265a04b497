// Two tests decide convexity.
//
// 1. Every edge. A surface that is closed, in one piece, and convex around each of its points bounds a convex body
//    (Tietze and Nakajima; for surfaces that might pass through themselves, van Heijenoort, "On locally convex
//    manifolds", 1952). "Around each point" means: the surface does not bend inwards at any edge, and the faces go
//    round every vertex once. With exact edges, this test would suffice. But edges that are flat within the rounding
//    of single precision must pass, and a finely tessellated dent can consist of such edges only.
// 2. Therefore every facet that has an edge too flat to decide is also tested as a whole: no vertex may lie beyond its
//    plane. Facets whose edges are all clearly convex need no such test as long as the faces go round each vertex
//    once. For small meshes all facets are tested: vertices x facets is cheap there. For large meshes, vertices are
//    looked up in a tree of boxes.
#include "geometry/parts/convex.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

// Up to this product of vertices and facets, every facet is tested against every vertex: a tenth of a second.
constexpr double small_product = 1e8;

struct Bend {
  double height;  // how far the nearer of the two opposite corners stands out, metres; positive: reflex
  double noise;   // possible rounding error of the height, metres
  double angle;   // radians beyond flat; positive: reflex
};

// How the surface bends at the edge of `side` and its twin.
Bend bend_at(const Mesh& mesh, std::uint32_t side, std::uint32_t twin, const std::vector<Vec3>& area_vectors,
             double tolerance) {
  const auto [from, to] = side_vertices(mesh, side);
  const Vec3 edge = mesh.positions[to] - mesh.positions[from];
  const double length = glm::length(edge);
  const Vec3& n0 = area_vectors[side / 3];
  const Vec3& n1 = area_vectors[twin / 3];
  const double twice0 = glm::length(n0), twice1 = glm::length(n1);
  if (!(length > 0) || !(twice0 > 0) || !(twice1 > 0)) return {0, tolerance, 0};
  // The triangles' heights over the edge are twice their area divided by its length. Each opposite corner stands over
  // the other triangle's plane by its height times the sine; the smaller value is the least affected by rounding.
  const double sine = -glm::dot(glm::cross(n0, n1), edge) / (twice0 * twice1 * length);
  const double cosine = glm::dot(n0, n1) / (twice0 * twice1);
  const double angle = std::atan2(sine, cosine);
  // Beyond a right angle, the sine decreases again although the corner comes no nearer.
  const double steepness = cosine < 0 ? std::copysign(1.0, sine) : sine;
  const double height = std::min(twice0, twice1) / length;
  // A narrow triangle's normal is uncertain by a coordinate's error divided by its width.
  const double uncertain =
      tolerance / 4 * (1 / triangle_width(mesh, side / 3, twice0) + 1 / triangle_width(mesh, twin / 3, twice1));
  return {height * steepness, std::max(tolerance, height * uncertain), angle};
}

// Vertices in a binary tree of boxes: finds one beyond a plane without testing all of them.
class VertexTree {
 public:
  explicit VertexTree(const std::vector<Vec3>& positions) : points_(positions) { build(0, points_.size()); }

  // Calls `beyond(position, height)` for every vertex higher than `limit` over the plane until it returns true.
  template <typename Beyond>
  bool any_beyond(const Plane& plane, double limit, const Beyond& beyond) const {
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      const Vec3 farthest(plane.normal.x > 0 ? node.box.high.x : node.box.low.x,
                          plane.normal.y > 0 ? node.box.high.y : node.box.low.y,
                          plane.normal.z > 0 ? node.box.high.z : node.box.low.z);
      if (glm::dot(plane.normal, farthest) - plane.offset <= limit) continue;
      if (node.second != 0) {
        stack.push_back(node.second);
        stack.push_back(static_cast<std::uint32_t>(&node - nodes_.data()) + 1);
        continue;
      }
      for (std::size_t i = node.begin; i < node.end; ++i) {
        const double height = glm::dot(plane.normal, points_[i]) - plane.offset;
        if (height > limit && beyond(points_[i], height)) return true;
      }
    }
    return false;
  }

 private:
  struct Node {
    Box box;
    std::size_t begin, end;
    std::uint32_t second = 0;  // the first child follows its parent; 0 in leaves
  };
  static constexpr std::size_t leaf_size = 8;

  void build(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({{}, begin, end});
    Box box;
    for (std::size_t i = begin; i < end; ++i)
      box.add(points_[i]);
    nodes_[self].box = box;
    if (end - begin <= leaf_size) return;
    const Vec3 extent = box.high - box.low;
    const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
    build(begin, middle);
    nodes_[self].second = static_cast<std::uint32_t>(nodes_.size());
    build(middle, end);
  }

  std::vector<Vec3> points_;
  std::vector<Node> nodes_;
};

// True if the faces around every vertex go round it exactly once, seen along the mean of their normals.
bool vertices_go_round_once(const Mesh& mesh, std::span<const std::uint32_t> twin,
                            const std::vector<Vec3>& area_vectors) {
  std::vector<Vec3> normal(mesh.positions.size(), Vec3(0));
  std::vector<std::uint32_t> faces(mesh.positions.size(), 0), leaving(mesh.positions.size());
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    const std::uint32_t v = side_vertices(mesh, side)[0];
    normal[v] += area_vectors[side / 3];
    ++faces[v];
    leaving[v] = side;
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const double length = glm::length(normal[v]);
    if (!(length > 0)) return false;
    const Vec3 axis = normal[v] / length;
    double turned = 0;
    std::uint32_t side = leaving[v], steps = 0;
    do {
      // From the side that leaves v to the next one counter-clockwise: back over the triangle's third side, to its
      // twin.
      const std::uint32_t next = twin[side - side % 3 + (side + 2) % 3];
      const Vec3 a = mesh.positions[side_vertices(mesh, side)[1]] - mesh.positions[v];
      const Vec3 b = mesh.positions[side_vertices(mesh, next)[1]] - mesh.positions[v];
      const Vec3 flat_a = a - axis * glm::dot(axis, a), flat_b = b - axis * glm::dot(axis, b);
      turned += std::atan2(glm::dot(axis, glm::cross(flat_a, flat_b)), glm::dot(flat_a, flat_b));
      side = next;
    } while (++steps < faces[v] && side != leaving[v]);
    // Fewer steps than faces: two fans of faces touch in this vertex.
    if (side != leaving[v] || steps != faces[v]) return false;
    if (std::abs(turned - 2 * std::numbers::pi) > 1) return false;
  }
  return true;
}

}  // namespace

double flatness_tolerance(const Mesh& mesh) {
  return flatness_tolerance(bounds(mesh));
}

double flatness_tolerance(const Box& box) {
  return box.empty() ? 0 : std::max(1e-6 * glm::distance(box.low, box.high), 2.5e-7 * box.reach());
}

bool has_reflex_edge(const Mesh& mesh, std::span<const std::uint32_t> twin, double tolerance) {
  std::vector<Vec3> area_vectors(mesh.triangles.size());
  for (std::uint32_t t = 0; t < area_vectors.size(); ++t)
    area_vectors[t] = area_vector(mesh, t);
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    if (twin[side] < side) continue;
    const Bend bend = bend_at(mesh, side, twin[side], area_vectors, tolerance);
    if (bend.height > bend.noise) return true;
  }
  return false;
}

std::optional<ReflexEdge> find_concavity(const Mesh& mesh, std::span<const std::uint32_t> twin, const Facets& facets,
                                         double tolerance) {
  std::vector<Vec3> area_vectors(mesh.triangles.size());
  for (std::uint32_t t = 0; t < area_vectors.size(); ++t)
    area_vectors[t] = area_vector(mesh, t);
  // For each facet: its most inward edge, and whether an edge to another facet is too flat to decide.
  struct Worst {
    double angle = -4;
    std::uint32_t side = 0;
  };
  std::vector<Worst> worst(facets.planes.size());
  std::vector<char> doubtful(facets.planes.size(), 0);
  Worst reflex;
  double highest = 0;
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    if (twin[side] < side) continue;
    const Bend bend = bend_at(mesh, side, twin[side], area_vectors, tolerance);
    if (bend.height > bend.noise && bend.height > highest) {
      highest = bend.height;
      reflex = {bend.angle, side};
    }
    const std::uint32_t f0 = facets.of_triangle[side / 3], f1 = facets.of_triangle[twin[side] / 3];
    for (const std::uint32_t f : {f0, f1}) {
      if (f == Facets::no_facet) continue;
      if (bend.angle > worst[f].angle) worst[f] = {bend.angle, side};
      if (f0 != f1 && bend.height > -bend.noise) doubtful[f] = 1;
    }
  }
  if (highest > 0) return ReflexEdge{side_vertices(mesh, reflex.side), reflex.angle};

  const double product = static_cast<double>(mesh.positions.size()) * static_cast<double>(facets.planes.size());
  const bool all = product <= small_product || !vertices_go_round_once(mesh, twin, area_vectors);
  std::optional<VertexTree> tree;
  for (std::uint32_t f = 0; f < facets.planes.size(); ++f) {
    if (!all && !doubtful[f]) continue;
    const Plane& plane = facets.planes[f];
    // The direction of a narrow facet is less certain, so its tolerance grows with the distance from it.
    const auto beyond = [&](const Vec3& p, double height) {
      return height > tolerance * (2 + glm::distance(p, facets.centres[f]) / facets.widths[f]);
    };
    bool outside = false;
    if (product <= small_product) {
      for (std::size_t i = 0; i < mesh.positions.size() && !outside; ++i) {
        const double height = glm::dot(plane.normal, mesh.positions[i]) - plane.offset;
        outside = height > 2 * tolerance && beyond(mesh.positions[i], height);
      }
    } else {
      if (!tree) tree.emplace(mesh.positions);
      outside = tree->any_beyond(plane, 2 * tolerance, beyond);
    }
    if (outside) return ReflexEdge{side_vertices(mesh, worst[f].side), std::max(worst[f].angle, 0.0)};
  }
  return std::nullopt;
}

}  // namespace palpa::geometry
