#include "acoustics/compressed/hierarchical_matrix.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "acoustics/boundary/near_pairs.hpp"
#include "acoustics/compressed/matrix_entries.hpp"
#include "base/activity.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

constexpr std::uint32_t leaf_size = 64;
/// Flat surfaces side by side are smooth functions of each other even if they are quite close.
constexpr double far_reach = 4;
constexpr std::uint32_t strip_size = 256;

/// About how many numbers a block has. Ranks as found on spheres and hands: they grow with the smaller cluster's size
/// in wavelengths.
std::uint64_t expected_numbers(const Cluster& rows, const Cluster& columns, bool far, double wave_number) {
  const double area = static_cast<double>(rows.size()) * columns.size(), lines = rows.size() + columns.size();
  const double smaller =
      std::min(glm::distance(rows.box.low, rows.box.high), glm::distance(columns.box.low, columns.box.high));
  const double rank = 7 + 1.1 * wave_number * smaller;
  return static_cast<std::uint64_t>(far ? std::min(rank * lines, area) : area);
}

}  // namespace

HierarchicalMatrix::HierarchicalMatrix(const Patches& body, double wave_number, double tolerance,
                                       const std::atomic<bool>* give_up)
    : tree_(cluster_tree(body.mesh, leaf_size)), stride_(split_stride(tree_.order.size())) {
  for (const BlockPlace& place : block_places(tree_, far_reach))
    blocks_.push_back({place, {}, {}});
  NearPairs near = near_pairs(body, wave_number, give_up);
  warn_of_unresolved(near);
  fill(MatrixEntries(body, tree_, wave_number, std::move(near)), wave_number, tolerance, give_up);
  find_strips();
}

void HierarchicalMatrix::fill(const MatrixEntries& entries, double wave_number, double tolerance,
                              const std::atomic<bool>* give_up) {
  // The largest ones first, so that all threads end at the same time.
  std::vector<std::uint32_t> sequence(blocks_.size());
  std::iota(sequence.begin(), sequence.end(), 0u);
  std::vector<std::uint64_t> costs;
  for (const Block& block : blocks_)
    costs.push_back(expected_numbers(lines(block, true), lines(block, false), block.place.far, wave_number));
  std::ranges::stable_sort(sequence, [&](std::uint32_t a, std::uint32_t b) { return costs[a] > costs[b]; });
  Activity activity("filling the matrix of the surface", std::accumulate(costs.begin(), costs.end(), std::uint64_t{0}));
  parallel_chunks(sequence.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
    stop_if(give_up);
    thread_local ClusterPatches rows, columns;
    thread_local LowRank product;
    Block& block = blocks_[sequence[chunk]];
    entries.select(lines(block, true), rows);
    entries.select(lines(block, false), columns);
    if (block.place.far) {
      const std::size_t most = std::size_t{rows.size} * columns.size / (rows.size + columns.size);
      block.place.far = approximate(entries, rows, columns, tolerance, most, product, give_up);
    }
    if (block.place.far) {
      // Copies, so that no memory is left over.
      block.far = product;
    } else {
      const std::size_t stride = split_stride(rows.size);
      block.whole.resize(2 * stride * columns.size);
      entries.block(rows, columns, stride, block.whole);
    }
    activity.advance(costs[sequence[chunk]]);
  });
}

void HierarchicalMatrix::find_strips() {
  for (const bool rows : {true, false}) {
    std::vector<Strip>& strips = rows ? row_strips_ : column_strips_;
    for (const Cluster& cluster : clusters_of(tree_, strip_size))
      strips.push_back({cluster.begin, cluster.end, {}});
    for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
      const Cluster& cluster = lines(blocks_[b], rows);
      for (auto strip = std::ranges::upper_bound(strips, cluster.begin, {}, &Strip::end);
           strip != strips.end() && strip->begin < cluster.end; ++strip)
        strip->blocks.push_back(b);
    }
  }
}

void HierarchicalMatrix::add(const Strip& strip, Way way, const Block& block, const float* factors,
                             const float* x_factors, const SplitVectors& x, std::size_t count,
                             const SplitVectors& y) const {
  const Cluster& rows = lines(block, true);
  const Cluster& columns = lines(block, false);
  const Cluster& own = way == Way::forth ? rows : columns;
  const std::uint32_t begin = std::max(strip.begin, own.begin), end = std::min(strip.end, own.end);
  const std::size_t padded = split_stride(end - begin);
  const SplitVectors at{y.of + begin, y.stride};
  if (block.place.far) {
    const std::vector<float>& side = way == Way::forth ? block.far.left : block.far.right;
    add_columns({side.data() + (begin - own.begin), padded, block.far.rank, split_stride(own.size())}, factors, count,
                at);
  } else if (way == Way::forth) {
    add_columns({block.whole.data() + (begin - rows.begin), padded, columns.size(), split_stride(rows.size())},
                x_factors + 2 * count * columns.begin, count, at);
  } else {
    const std::size_t stride = split_stride(rows.size());
    thread_local std::vector<float> dots;
    dots.resize(2 * count * (end - begin));
    dot_columns({block.whole.data() + 2 * stride * (begin - columns.begin), stride, end - begin, stride},
                {x.of + rows.begin, x.stride}, count, dots.data());
    for (std::size_t i = 0; i < end - begin; ++i) {
      for (std::size_t v = 0; v < count; ++v) {
        at.of[2 * at.stride * v + i] += dots[2 * (i * count + v)];
        at.of[2 * at.stride * v + at.stride + i] += dots[2 * (i * count + v) + 1];
      }
    }
  }
}

void HierarchicalMatrix::multiply(Way way, const SplitVectors& x, std::size_t count, const SplitVectors& y) const {
  // First the factors of all products' outer vectors, then each strip's sum over the blocks that cross it.
  std::vector<std::size_t> first(blocks_.size() + 1);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    first[b + 1] = first[b] + (blocks_[b].place.far ? 2 * count * blocks_[b].far.rank : 0);
  std::vector<float> factors(first.back());
  parallel_chunks(blocks_.size(), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const Block& block = blocks_[b];
      if (!block.place.far) continue;
      const Cluster& other = lines(block, way == Way::back);
      const std::size_t padded = split_stride(other.size());
      const std::vector<float>& side = way == Way::forth ? block.far.right : block.far.left;
      dot_columns({side.data(), padded, block.far.rank, padded}, {x.of + other.begin, x.stride}, count,
                  &factors[first[b]]);
    }
  });
  std::vector<float> x_factors;
  if (way == Way::forth) {
    x_factors.resize(2 * count * stride_);
    for (std::size_t v = 0; v < count; ++v) {
      for (std::size_t i = 0; i < stride_; ++i) {
        x_factors[2 * (i * count + v)] = x.of[2 * x.stride * v + i];
        x_factors[2 * (i * count + v) + 1] = x.of[2 * x.stride * v + x.stride + i];
      }
    }
  }
  const std::vector<Strip>& strips = way == Way::forth ? row_strips_ : column_strips_;
  parallel_chunks(strips.size(), 1, [&](std::size_t strip, std::size_t, std::size_t) {
    const std::size_t begin = strips[strip].begin, padded = split_stride(strips[strip].end - begin);
    for (std::size_t v = 0; v < count; ++v) {
      std::fill_n(y.of + 2 * y.stride * v + begin, padded, 0.0F);
      std::fill_n(y.of + 2 * y.stride * v + y.stride + begin, padded, 0.0F);
    }
    for (const std::uint32_t b : strips[strip].blocks)
      add(strips[strip], way, blocks_[b], factors.data() + first[b], x_factors.data(), x, count, y);
  });
}

std::vector<HierarchicalMatrix::Square> HierarchicalMatrix::squares(std::uint32_t most) const {
  std::vector<Square> found;
  for (const Cluster& cluster : clusters_of(tree_, most))
    found.push_back({cluster.begin, cluster.end});
  return found;
}

std::vector<std::complex<float>> HierarchicalMatrix::entries(const Square& square) const {
  const std::size_t size = square.end - square.begin;
  std::vector<std::complex<float>> matrix(size * size);
  std::vector<float> column, factors;
  const auto strip = std::ranges::upper_bound(row_strips_, square.begin, {}, &Strip::end);
  std::vector<std::uint32_t> crossing;
  for (auto at = strip; at != row_strips_.end() && at->begin < square.end; ++at)
    crossing.insert(crossing.end(), at->blocks.begin(), at->blocks.end());
  std::ranges::sort(crossing);
  crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
  for (const std::uint32_t b : crossing) {
    const Cluster& rows = lines(blocks_[b], true);
    const Cluster& columns = lines(blocks_[b], false);
    if (rows.begin < square.begin || rows.end > square.end || columns.begin < square.begin || columns.end > square.end)
      continue;
    const std::size_t stride = split_stride(rows.size()), other = split_stride(columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const float* from = nullptr;
      if (blocks_[b].place.far) {
        const LowRank& far = blocks_[b].far;
        column.assign(2 * stride, 0);
        factors.resize(2 * far.rank);
        for (std::size_t r = 0; r < far.rank; ++r) {
          factors[2 * r] = far.right[2 * other * r + c];
          factors[2 * r + 1] = far.right[2 * other * r + other + c];
        }
        add_columns({far.left.data(), stride, far.rank, stride}, factors.data(), 1, {column.data(), stride});
        from = column.data();
      } else {
        from = &blocks_[b].whole[2 * stride * c];
      }
      for (std::size_t i = 0; i < rows.size(); ++i)
        matrix[(rows.begin - square.begin + i) * size + columns.begin - square.begin + c] = {from[i], from[stride + i]};
    }
  }
  return matrix;
}

std::uint64_t HierarchicalMatrix::bytes() const {
  std::uint64_t sum = 0;
  for (const Block& block : blocks_)
    sum += (block.far.left.size() + block.far.right.size() + block.whole.size()) * sizeof(float) + sizeof(Block);
  return sum;
}

std::uint64_t HierarchicalMatrix::expected_bytes(const geometry::Mesh& body, double wave_number) {
  const ClusterTree tree = cluster_tree(body, leaf_size);
  std::uint64_t numbers = 0, blocks = 0;
  for (const BlockPlace& place : block_places(tree, far_reach)) {
    numbers += expected_numbers(tree.clusters[place.rows], tree.clusters[place.columns], place.far, wave_number);
    ++blocks;
  }
  return numbers * sizeof(std::complex<float>) + blocks * sizeof(Block);
}

}  // namespace palpa::acoustics
