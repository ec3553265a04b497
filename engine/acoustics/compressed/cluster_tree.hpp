// The vertices of a surface in a binary tree of clusters: neighbours in space are neighbours in the tree's order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

struct Cluster {
  std::uint32_t begin, end;         ///< places in ClusterTree::order
  std::uint32_t first = 0, second;  ///< children; a leaf has none
  Box box;                          ///< around the faces of the vertices
  double longest_side = 0;          ///< of these faces
  bool leaf() const { return first == 0; }
  std::uint32_t size() const { return end - begin; }
};

/// The number of a cluster's vertices is a multiple of this, except in the last cluster of the order.
inline constexpr std::uint32_t cluster_lanes = 16;

struct ClusterTree {
  std::vector<Cluster> clusters;     ///< parents before their children; the first one has all vertices
  std::vector<std::uint32_t> order;  ///< the vertices, cluster after cluster
};

/// Divides at the median along the longest axis of the vertices' box until a cluster has at most `leaf_size` vertices.
ClusterTree cluster_tree(const geometry::Mesh& mesh, std::uint32_t leaf_size);

/// The largest clusters of at most `most` vertices each, or leaves; in order.
std::vector<Cluster> clusters_of(const ClusterTree& tree, std::uint32_t most);

/// A block of the matrix: the cluster of its rows, the cluster of its columns, and whether these are so far from each
/// other that the block can be compressed.
struct BlockPlace {
  std::uint32_t rows, columns;
  bool far;
};

/// All blocks of a matrix, which cover it without overlap. Clusters are far from each other if the smaller one's
/// diagonal is at most `reach` times their distance, and no pair of their faces is near (near_pairs.hpp).
std::vector<BlockPlace> block_places(const ClusterTree& tree, double reach);

}  // namespace palpa::acoustics
