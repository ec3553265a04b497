#include "assets/generators/remesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <utility>
#include <vector>

namespace palpa::assets {
namespace {

using geometry::Mesh;
using Index = std::uint32_t;

class Remesher {
 public:
  Remesher(Mesh mesh, const Field& field, const Sizing& sizing)
      : positions_(std::move(mesh.positions)), triangles_(std::move(mesh.triangles)), field_(field), sizing_(sizing) {
    around_.resize(positions_.size());
    for (Index t = 0; t < triangles_.size(); ++t) {
      for (int c = 0; c < 3; ++c)
        around_[triangles_[t][c]].push_back(t);
    }
  }

  Mesh run(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      measure();
      split_long_edges();
      collapse_short_edges();
      even_valences();
      relax(1);
    }
    relax(3);
    return finish();
  }

 private:
  using Edge = std::pair<Index, Index>;

  /// The triangles on an edge: two, in a closed manifold.
  struct Sides {
    std::array<Index, 2> triangles{};
    std::size_t count = 0;
    void add(Index t) {
      if (count < 2) triangles[count] = t;
      ++count;
    }
  };

  void measure() {
    size_.resize(positions_.size());
    for (std::size_t v = 0; v < positions_.size(); ++v)
      size_[v] = sizing_(positions_[v]);
  }

  double wanted(Index p, Index q) const { return 0.5 * (size_[p] + size_[q]); }
  double length(Index p, Index q) const { return glm::distance(positions_[p], positions_[q]); }

  /// Every edge once, in the order of triangles.
  std::vector<Edge> edges() const {
    std::vector<Edge> all;
    for (const glm::uvec3& t : triangles_) {
      if (t.x == t.y) continue;
      for (int c = 0; c < 3; ++c) {
        if (t[c] < t[(c + 1) % 3]) all.emplace_back(t[c], t[(c + 1) % 3]);
      }
    }
    return all;
  }

  /// The two triangles on an edge, or fewer than two if the edge no longer exists.
  Sides triangles_on(Index p, Index q) const {
    Sides found;
    for (const Index t : around_[p]) {
      const glm::uvec3& v = triangles_[t];
      if (v.x == q || v.y == q || v.z == q) found.add(t);
    }
    return found;
  }

  Index opposite(Index t, Index p, Index q) const {
    const glm::uvec3& v = triangles_[t];
    for (int c = 0; c < 3; ++c) {
      if (v[c] != p && v[c] != q) return v[c];
    }
    return v.x;
  }

  void replace_corner(Index t, Index from, Index to) {
    for (int c = 0; c < 3; ++c) {
      if (triangles_[t][c] == from) triangles_[t][c] = to;
    }
  }

  void forget(Index v, Index t) { std::erase(around_[v], t); }

  std::vector<Index> neighbours(Index v) const {
    std::vector<Index> ring;
    for (const Index t : around_[v]) {
      for (int c = 0; c < 3; ++c) {
        if (triangles_[t][c] != v) ring.push_back(triangles_[t][c]);
      }
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }

  Vec3 area_normal(const glm::uvec3& t) const {
    return glm::cross(positions_[t.y] - positions_[t.x], positions_[t.z] - positions_[t.x]);
  }

  void split_long_edges() {
    for (const auto& [p, q] : edges()) {
      if (length(p, q) <= 4.0 / 3.0 * wanted(p, q)) continue;
      const Sides sides = triangles_on(p, q);
      if (sides.count != 2) continue;
      const auto middle = static_cast<Index>(positions_.size());
      positions_.push_back(0.5 * (positions_[p] + positions_[q]));
      size_.push_back(sizing_(positions_.back()));
      around_.emplace_back();
      for (const Index t : sides.triangles) {
        // t keeps p; its copy gets q.
        const auto copy = static_cast<Index>(triangles_.size());
        triangles_.push_back(triangles_[t]);
        replace_corner(t, q, middle);
        replace_corner(copy, p, middle);
        forget(q, t);
        around_[q].push_back(copy);
        around_[middle].push_back(t);
        around_[middle].push_back(copy);
        around_[opposite(copy, q, middle)].push_back(copy);
      }
    }
  }

  /// Whether q may be merged into p at `place`: this must not pinch off a handle, turn over a triangle or make an edge
  /// long.
  bool may_collapse(Index p, Index q, const Vec3& place) const {
    const std::vector<Index> ring_p = neighbours(p), ring_q = neighbours(q);
    std::vector<Index> common;
    std::set_intersection(ring_p.begin(), ring_p.end(), ring_q.begin(), ring_q.end(), std::back_inserter(common));
    if (common.size() != 2) return false;
    for (const Index v : common) {
      if (around_[v].size() <= 4) return false;
    }
    if (ring_p.size() + ring_q.size() > 14) return false;
    for (const auto* ring : {&ring_p, &ring_q}) {
      for (const Index v : *ring) {
        if (v != p && v != q && glm::distance(positions_[v], place) > 4.0 / 3.0 * 0.5 * (size_[v] + size_[p]))
          return false;
      }
    }
    for (const Index end : {p, q}) {
      for (const Index t : around_[end]) {
        const glm::uvec3& v = triangles_[t];
        const Index other = end == p ? q : p;
        if (v.x == other || v.y == other || v.z == other) continue;
        std::array<Vec3, 3> moved{positions_[v.x], positions_[v.y], positions_[v.z]};
        for (int c = 0; c < 3; ++c) {
          if (v[c] == end) moved[c] = place;
        }
        const Vec3 before = area_normal(v), after = glm::cross(moved[1] - moved[0], moved[2] - moved[0]);
        if (glm::dot(before, after) <= 0.3 * glm::length(before) * glm::length(after)) return false;
      }
    }
    return true;
  }

  void collapse_short_edges() {
    for (const auto& [p, q] : edges()) {
      if (around_[p].empty() || around_[q].empty() || length(p, q) >= 0.8 * wanted(p, q)) continue;
      const Sides sides = triangles_on(p, q);
      const Vec3 place = 0.5 * (positions_[p] + positions_[q]);
      if (sides.count != 2 || !may_collapse(p, q, place)) continue;
      for (const Index t : sides.triangles) {
        const glm::uvec3 v = triangles_[t];
        for (int c = 0; c < 3; ++c)
          forget(v[c], t);
        triangles_[t] = {0, 0, 0};
      }
      for (const Index t : around_[q]) {
        replace_corner(t, q, p);
        around_[p].push_back(t);
      }
      around_[q].clear();
      positions_[p] = place;
    }
  }

  /// Flips edges if this brings the four valences nearer to six and turns no triangle over.
  void even_valences() {
    for (const auto& [p, q] : edges()) {
      const Sides sides = triangles_on(p, q);
      if (sides.count != 2) continue;
      const Index r = opposite(sides.triangles[0], p, q), s = opposite(sides.triangles[1], p, q);
      const auto excess = [&](Index v, int change) {
        const int d = static_cast<int>(around_[v].size()) + change - 6;
        return d * d;
      };
      const int before = excess(p, 0) + excess(q, 0) + excess(r, 0) + excess(s, 0);
      const int after = excess(p, -1) + excess(q, -1) + excess(r, 1) + excess(s, 1);
      if (after >= before || around_[p].size() <= 4 || around_[q].size() <= 4 || triangles_on(r, s).count != 0)
        continue;
      // The side that runs p -> q comes first.
      const glm::uvec3& v = triangles_[sides.triangles[0]];
      const bool forward = (v.x == p && v.y == q) || (v.y == p && v.z == q) || (v.z == p && v.x == q);
      const Index left = forward ? r : s, right = forward ? s : r;
      const glm::uvec3 first{p, right, left}, second{right, q, left};
      const Vec3 sum = area_normal(triangles_[sides.triangles[0]]) + area_normal(triangles_[sides.triangles[1]]);
      const auto faces_away = [&](const glm::uvec3& t) {
        const Vec3 n = area_normal(t);
        return glm::dot(n, sum) <= 0.5 * glm::length(n) * glm::length(sum);
      };
      if (faces_away(first) || faces_away(second)) continue;
      triangles_[sides.triangles[0]] = first;
      triangles_[sides.triangles[1]] = second;
      forget(q, sides.triangles[0]);
      forget(p, sides.triangles[1]);
      // sides.triangles[0] lost q and gained the other side's corner, sides.triangles[1] lost p and gained the first
      // side's.
      around_[s].push_back(sides.triangles[0]);
      around_[r].push_back(sides.triangles[1]);
    }
  }

  /// One step of Newton's method towards field = 0, along a one-sided gradient.
  Vec3 projected(const Vec3& p) const {
    constexpr double kStep = 1e-6;
    const double here = field_(p);
    const Vec3 g =
        (Vec3(field_(p + Vec3(kStep, 0, 0)), field_(p + Vec3(0, kStep, 0)), field_(p + Vec3(0, 0, kStep))) - here) /
        kStep;
    return p - g * (here / std::max(glm::dot(g, g), 0.1));
  }

  /// Moves every vertex along the surface to the middle of its neighbours, then back onto the surface.
  void relax(int newton_steps) {
    std::vector<Vec3> moved = positions_;
    for (Index v = 0; v < positions_.size(); ++v) {
      if (around_[v].empty()) continue;
      // Triangles are weighted by area over the wanted area, so that the grading stays.
      Vec3 centre(0.0), normal(0.0);
      double weight = 0.0;
      for (const Index t : around_[v]) {
        const glm::uvec3& c = triangles_[t];
        const Vec3 n = area_normal(c);
        const Vec3 middle = (positions_[c.x] + positions_[c.y] + positions_[c.z]) / 3.0;
        const double size = sizing_(middle), w = glm::length(n) / (size * size * size * size);
        centre += w * middle;
        weight += w;
        normal += n;
      }
      if (weight <= 0.0 || glm::length(normal) <= 0.0) continue;
      normal = glm::normalize(normal);
      const Vec3 step = centre / weight - positions_[v];
      moved[v] = positions_[v] + (step - normal * glm::dot(step, normal));
      for (int i = 0; i < newton_steps; ++i)
        moved[v] = projected(moved[v]);
    }
    positions_ = std::move(moved);
  }

  /// Without dead triangles and vertices, in the order of first use.
  Mesh finish() {
    Mesh mesh;
    constexpr Index kNone = ~Index{0};
    std::vector<Index> fresh(positions_.size(), kNone);
    for (const glm::uvec3& t : triangles_) {
      if (t.x == t.y) continue;
      glm::uvec3 renamed{};
      for (int c = 0; c < 3; ++c) {
        Index& name = fresh[t[c]];
        if (name == kNone) {
          name = static_cast<Index>(mesh.positions.size());
          mesh.positions.push_back(positions_[t[c]]);
        }
        renamed[c] = name;
      }
      mesh.triangles.push_back(renamed);
    }
    return mesh;
  }

  std::vector<Vec3> positions_;
  std::vector<glm::uvec3> triangles_;  ///< {0, 0, 0} if dead
  std::vector<std::vector<Index>> around_;
  std::vector<double> size_;  ///< wanted edge length at each vertex
  const Field& field_;
  const Sizing& sizing_;
};

}  // namespace

Mesh remesh(Mesh mesh, const Field& field, const Sizing& sizing, int rounds) {
  return Remesher(std::move(mesh), field, sizing).run(rounds);
}

}  // namespace palpa::assets
