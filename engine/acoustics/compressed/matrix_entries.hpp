// Parts of the boundary elements' matrix (galerkin.hpp): single rows and columns of distant blocks, and whole blocks.
// The entries are those of assemble().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/boundary/far_tables.hpp"
#include "acoustics/boundary/near_pairs.hpp"
#include "acoustics/compressed/cluster_tree.hpp"
#include "acoustics/compressed/hat_kernels.hpp"

namespace palpa::acoustics {

/// Real and imaginary parts, apart from each other: vectors of a block.
struct SplitSpan {
  float *re, *im;
};

/// The patches around a cluster's vertices.
struct ClusterPatches {
  std::uint32_t begin = 0, size = 0;                  ///< of the cluster, in the tree's order
  std::vector<std::uint32_t> patches;                 ///< ascending
  std::vector<FarGroup> groups;                       ///< these patches
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< a corner's place in the cluster; `size` if it is outside
};

class MatrixEntries {
 public:
  /// `body` and `tree` must outlive it.
  MatrixEntries(const Patches& body, const ClusterTree& tree, double wave_number, NearPairs near);

  /// Replaces `out`; its memory is used again.
  void select(const Cluster& cluster, ClusterPatches& out) const;

  /// The row at that place of the order, for all columns of a cluster far from it.
  void row(std::uint32_t place, const ClusterPatches& columns, SplitSpan out) const;
  /// The column at that place of the order, for all rows of a cluster far from it.
  void column(std::uint32_t place, const ClusterPatches& rows, SplitSpan out) const;

  /// The entries of a block of any two clusters, column after column: `stride` floats of real parts, then as many
  /// imaginary ones. Entries beyond the rows are zero.
  void block(const ClusterPatches& rows, const ClusterPatches& columns, std::size_t stride, std::span<float> out) const;

 private:
  using HatKernel = decltype(hat_row);  // or hat_column
  void line(std::uint32_t place, const ClusterPatches& others, const HatKernel& kernel, SplitSpan out) const;
  void hat_at(std::uint32_t place, std::vector<HatSample>& hat) const;

  const Patches& body_;
  const ClusterTree& tree_;
  float wave_number_;
  NearPairs near_;
  std::vector<FarPatch> far_;
  Around around_;
  std::vector<std::uint32_t> place_of_;  // by vertex
};

}  // namespace palpa::acoustics
