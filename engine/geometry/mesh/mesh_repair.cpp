#include "geometry/mesh/mesh_repair.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <unordered_set>

#include "geometry/mesh/topology.hpp"
#include "geometry/seeded_hash.hpp"

namespace palpa::geometry {
namespace {

struct Key {
  glm::uvec3 sorted;
  bool even;  // an even number of swaps sorts it
};

Key key_of(glm::uvec3 t) {
  bool even = true;
  const auto order = [&](int a, int b) {
    if (t[a] <= t[b]) return;
    std::swap(t[a], t[b]);
    even = !even;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {t, even};
}

bool less(const glm::uvec3& a, const glm::uvec3& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

struct EdgeHash {
  std::size_t operator()(std::uint64_t edge) const { return mix_hash(hash_seed(), edge); }
};

class Turner {
 public:
  Turner(Mesh& mesh, double width) : mesh_(mesh), width_(width), twin_(twins(mesh)) {}

  std::size_t run() {
    std::vector<std::uint32_t> narrow;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!(triangle_width(mesh_, t) > width_)) narrow.push_back(t);
    }
    std::size_t turned = 0, steps = 0;
    const std::size_t most = 8 * narrow.size();  // a flip may leave another needle
    while (!narrow.empty() && steps++ < most) {
      const std::uint32_t t = narrow.back();
      narrow.pop_back();
      const double before = triangle_width(mesh_, t);
      if (before > width_ || !turn(t, before, narrow)) continue;
      ++turned;
    }
    return turned;
  }

 private:
  std::uint32_t longest_side(std::uint32_t t) const {
    std::uint32_t best = 3 * t;
    double length = -1;
    for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
      const auto [a, b] = side_vertices(mesh_, side);
      const double l = glm::distance(mesh_.positions[a], mesh_.positions[b]);
      if (l > length) best = side;
      length = std::max(length, l);
    }
    return best;
  }

  static std::uint64_t edge(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
  }

  // Uses a table, because going round a vertex that all needles share would cost the square of their number.
  bool are_neighbours(std::uint32_t c, std::uint32_t d) {
    if (edges_.empty()) {
      edges_.reserve(twin_.size() / 2);
      for (std::uint32_t side = 0; side < twin_.size(); ++side) {
        const auto [a, b] = side_vertices(mesh_, side);
        if (a < b) edges_.insert(edge(a, b));
      }
    }
    return edges_.contains(edge(c, d));
  }

  bool turn(std::uint32_t t, double before, std::vector<std::uint32_t>& narrow) {
    const std::uint32_t ab = longest_side(t), bc = t * 3 + (ab + 1 - t * 3) % 3, ca = t * 3 + (ab + 2 - t * 3) % 3;
    const std::uint32_t ba = twin_[ab], u = ba / 3, ad = u * 3 + (ba + 1 - u * 3) % 3,
                        db = u * 3 + (ba + 2 - u * 3) % 3;
    const std::uint32_t c = opposite_vertex(mesh_, ab), d = opposite_vertex(mesh_, ba);
    const auto [a, b] = side_vertices(mesh_, ab);
    if (c == d || u == t || are_neighbours(c, d)) return false;
    const Vec3 along = mesh_.positions[b] - mesh_.positions[a];
    const double part = glm::dot(mesh_.positions[c] - mesh_.positions[a], along) / glm::dot(along, along);
    if (!(part > 1e-6 && part < 1 - 1e-6)) return false;
    const glm::uvec3 old_t = mesh_.triangles[t], old_u = mesh_.triangles[u];
    mesh_.triangles[t] = {a, d, c};
    mesh_.triangles[u] = {d, b, c};
    const double now = std::min(triangle_width(mesh_, t), triangle_width(mesh_, u));
    if (!(now > before)) {
      mesh_.triangles[t] = old_t;
      mesh_.triangles[u] = old_u;
      return false;
    }
    const std::uint32_t over_ad = twin_[ad], over_db = twin_[db], over_bc = twin_[bc], over_ca = twin_[ca];
    const auto join = [&](std::uint32_t x, std::uint32_t y) {
      twin_[x] = y;
      twin_[y] = x;
    };
    // Sides whose twins were each other's stay so only with the new numbers.
    const auto moved = [&](std::uint32_t side) {
      return side == ad ? 3 * t : side == db ? 3 * u : side == bc ? 3 * u + 1 : side == ca ? 3 * t + 2 : side;
    };
    join(3 * t, moved(over_ad));
    join(3 * u, moved(over_db));
    join(3 * u + 1, moved(over_bc));
    join(3 * t + 2, moved(over_ca));
    join(3 * t + 1, 3 * u + 2);
    edges_.erase(edge(a, b));
    edges_.insert(edge(c, d));
    for (const std::uint32_t again : {t, u}) {
      if (!(triangle_width(mesh_, again) > width_)) narrow.push_back(again);
    }
    return true;
  }

  Mesh& mesh_;
  double width_;
  std::vector<std::uint32_t> twin_;
  std::unordered_set<std::uint64_t, EdgeHash> edges_;  // filled when first asked for
};

}  // namespace

Dropped drop_duplicates(Mesh& mesh) {
  std::vector<Key> keys;
  keys.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    keys.push_back(key_of(t));
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return keys[a].sorted != keys[b].sorted ? less(keys[a].sorted, keys[b].sorted) : a < b;
  });
  Dropped dropped;
  std::vector<char> stays(keys.size(), 0);
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i, even = 0;
    for (; end < order.size() && keys[order[end]].sorted == keys[order[i]].sorted; ++end)
      even += keys[order[end]].even ? 1 : 0;
    const std::size_t odd = end - i - even, pairs = std::min(even, odd);
    dropped.back_to_back += pairs;
    const bool one_stays = even != odd;
    dropped.duplicates += end - i - 2 * pairs - (one_stays ? 1 : 0);
    if (one_stays) {
      std::size_t first = i;
      while (keys[order[first]].even != (even > odd))
        ++first;
      stays[order[first]] = 1;
    }
    i = end;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < stays.size(); ++t) {
    if (stays[t] != 0) mesh.triangles[kept++] = mesh.triangles[t];
  }
  mesh.triangles.resize(kept);
  return dropped;
}

std::size_t turn_needles(Mesh& mesh, double width) {
  return Turner(mesh, width).run();
}

}  // namespace palpa::geometry
