// The boundary elements' matrix (galerkin.hpp) in blocks: those of distant clusters as short products (low_rank.hpp),
// all others as they are. Memory and time grow almost linearly with the number of vertices (Hackbusch 1999).
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/compressed/cluster_tree.hpp"
#include "acoustics/compressed/low_rank.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

class HierarchicalMatrix {
 public:
  /// Each far block's relative error is about `tolerance` (low_rank.hpp). Warns as assemble() does. The matrix has the
  /// same bytes for any number of threads. Throws GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
  HierarchicalMatrix(const Patches& body, double wave_number, double tolerance,
                     const std::atomic<bool>* give_up = nullptr);

  /// Vectors below are in this order of the vertices; `stride` is their number rounded up (split_kernels.hpp).
  const std::vector<std::uint32_t>& order() const { return tree_.order; }
  std::size_t stride() const { return stride_; }

  /// Replaces `count` vectors y by the matrix (or its transposed) times x. The same bytes for any number of threads.
  void multiply(Way way, const SplitVectors& x, std::size_t count, const SplitVectors& y) const;

  /// Squares along the diagonal that cover it: [begin, end), the largest clusters of at most `most` vertices.
  struct Square {
    std::uint32_t begin, end;
  };
  std::vector<Square> squares(std::uint32_t most) const;
  /// The entries of such a square, row-major.
  std::vector<std::complex<float>> entries(const Square& square) const;

  std::uint64_t bytes() const;
  /// An estimate of bytes().
  static std::uint64_t expected_bytes(const geometry::Mesh& body, double wave_number);

 private:
  struct Block {
    BlockPlace place;
    LowRank far;               // if place.far
    std::vector<float> whole;  // otherwise: a split matrix
  };
  /// Rows or columns that one thread computes at once, and the blocks that they cross.
  struct Strip {
    std::uint32_t begin, end;
    std::vector<std::uint32_t> blocks;
  };

  void fill(const MatrixEntries& entries, double wave_number, double tolerance, const std::atomic<bool>* give_up);
  void find_strips();
  const Cluster& lines(const Block& block, bool rows) const {
    return tree_.clusters[rows ? block.place.rows : block.place.columns];
  }
  void add(const Strip& strip, Way way, const Block& block, const float* factors, const float* x_factors,
           const SplitVectors& x, std::size_t count, const SplitVectors& y) const;

  ClusterTree tree_;
  std::size_t stride_;
  std::vector<Block> blocks_;
  std::vector<Strip> row_strips_, column_strips_;
};

}  // namespace palpa::acoustics
