#include "acoustics/compressed/cluster_tree.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "acoustics/boundary/near_pairs.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

using geometry::Mesh;

struct Star {
  Box box;
  double longest_side = 0;
};

/// What the faces around each vertex have in common.
std::vector<Star> stars_of(const Mesh& mesh) {
  std::vector<Star> stars(mesh.positions.size());
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3& t = mesh.triangles[face];
    const double side = longest_side(mesh, face);
    for (int c = 0; c < 3; ++c) {
      Star& star = stars[t[c]];
      star.longest_side = std::max(star.longest_side, side);
      for (int i = 0; i < 3; ++i)
        star.box.add(mesh.positions[t[i]]);
    }
  }
  return stars;
}

class Builder {
 public:
  Builder(const Mesh& mesh, std::uint32_t leaf_size) : mesh_(mesh), stars_(stars_of(mesh)), leaf_size_(leaf_size) {
    tree_.order.resize(mesh.positions.size());
    std::iota(tree_.order.begin(), tree_.order.end(), 0u);
    divide(0, static_cast<std::uint32_t>(tree_.order.size()));
  }
  ClusterTree take() { return std::move(tree_); }

 private:
  std::uint32_t divide(std::uint32_t begin, std::uint32_t end) {
    const auto own = static_cast<std::uint32_t>(tree_.clusters.size());
    Cluster cluster{begin, end, 0, 0, {}, 0};
    Box vertices;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t v = tree_.order[i];
      vertices.add(mesh_.positions[v]);
      cluster.box.add(stars_[v].box.low);
      cluster.box.add(stars_[v].box.high);
      cluster.longest_side = std::max(cluster.longest_side, stars_[v].longest_side);
    }
    tree_.clusters.push_back(cluster);
    if (end - begin <= leaf_size_) return own;
    const Vec3 extent = vertices.high - vertices.low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t half = ((end - begin) / 2 + cluster_lanes - 1) / cluster_lanes * cluster_lanes;
    const auto from = tree_.order.begin();
    std::nth_element(from + begin, from + begin + half, from + end, [&](std::uint32_t a, std::uint32_t b) {
      const double at = mesh_.positions[a][axis], other = mesh_.positions[b][axis];
      return at != other ? at < other : a < b;
    });
    std::sort(from + begin, from + begin + half);
    std::sort(from + begin + half, from + end);
    const std::uint32_t first = divide(begin, begin + half);
    const std::uint32_t second = divide(begin + half, end);
    tree_.clusters[own].first = first;
    tree_.clusters[own].second = second;
    return own;
  }

  const Mesh& mesh_;
  std::vector<Star> stars_;
  std::uint32_t leaf_size_;
  ClusterTree tree_;
};

bool are_far(const Cluster& a, const Cluster& b, double reach) {
  Vec3 gap(0);
  for (int axis = 0; axis < 3; ++axis)
    gap[axis] = std::max({a.box.low[axis] - b.box.high[axis], b.box.low[axis] - a.box.high[axis], 0.0});
  const double distance = glm::length(gap);
  const double smaller = std::min(glm::distance(a.box.low, a.box.high), glm::distance(b.box.low, b.box.high));
  return distance > 0 && smaller <= reach * distance &&
         distance >= near_reach * std::max(a.longest_side, b.longest_side);
}

void add_places(const ClusterTree& tree, std::uint32_t rows, std::uint32_t columns, double reach,
                std::vector<BlockPlace>& places) {
  const Cluster &a = tree.clusters[rows], &b = tree.clusters[columns];
  const bool far = are_far(a, b, reach);
  if (far || (a.leaf() && b.leaf())) {
    places.push_back({rows, columns, far});
    return;
  }
  const bool split_rows = !a.leaf() && (b.leaf() || 2 * a.size() > b.size());
  const bool split_columns = !b.leaf() && (a.leaf() || 2 * b.size() > a.size());
  for (const std::uint32_t row : split_rows ? std::vector{a.first, a.second} : std::vector{rows}) {
    for (const std::uint32_t column : split_columns ? std::vector{b.first, b.second} : std::vector{columns})
      add_places(tree, row, column, reach, places);
  }
}

}  // namespace

ClusterTree cluster_tree(const Mesh& mesh, std::uint32_t leaf_size) {
  return Builder(mesh, leaf_size).take();
}

std::vector<Cluster> clusters_of(const ClusterTree& tree, std::uint32_t most) {
  std::vector<Cluster> found;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Cluster& cluster = tree.clusters[open.back()];
    open.pop_back();
    if (cluster.leaf() || cluster.size() <= most) {
      found.push_back(cluster);
    } else {
      open.insert(open.end(), {cluster.second, cluster.first});
    }
  }
  return found;
}

std::vector<BlockPlace> block_places(const ClusterTree& tree, double reach) {
  std::vector<BlockPlace> places;
  add_places(tree, 0, 0, reach, places);
  return places;
}

}  // namespace palpa::acoustics
