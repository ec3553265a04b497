// The parts of the compressed matrix: clusters, short products, and sums of split numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "acoustics/boundary/galerkin.hpp"
#include "acoustics/boundary/near_pairs.hpp"
#include "acoustics/compressed/cluster_tree.hpp"
#include "acoustics/compressed/hierarchical_matrix.hpp"
#include "acoustics/compressed/low_rank.hpp"
#include "acoustics/compressed/matrix_entries.hpp"
#include "acoustics/compressed/split_kernels.hpp"
#include "acoustics/rigs.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/shapes.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double k = 732.5;

std::vector<float> noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> of(count);
  for (float& x : of)
    x = normal(random);
  return of;
}

TEST(SplitKernels, AreProducts) {
  constexpr std::size_t stride = 64;
  for (const std::size_t rows : {16u, 48u, 64u}) {
    for (const std::size_t columns : {0u, 1u, 3u, 4u, 11u}) {
      for (const std::size_t count : {1u, 2u, 3u, 10u}) {
        const std::vector<float> matrix = noise(2 * stride * columns + 1, 1),
                                 factors = noise(2 * columns * count + 1, 2);
        std::vector<float> x = noise(2 * stride * count, 3), y = x, dots(2 * columns * count);
        const SplitMatrix m{matrix.data(), rows, columns, stride};
        add_columns(m, factors.data(), count, {y.data(), stride});
        dot_columns(m, {x.data(), stride}, count, dots.data());
        const auto entry = [&](std::size_t row, std::size_t column) {
          return Complex(matrix[2 * stride * column + row], matrix[2 * stride * column + stride + row]);
        };
        for (std::size_t v = 0; v < count; ++v) {
          const auto at = [&](const std::vector<float>& vector, std::size_t row) {
            return Complex(vector[2 * stride * v + row], vector[2 * stride * v + stride + row]);
          };
          for (std::size_t row = 0; row < stride; ++row) {
            Complex sum = at(x, row);
            for (std::size_t c = 0; c < columns && row < rows; ++c)
              sum += entry(row, c) * Complex(factors[2 * (c * count + v)], factors[2 * (c * count + v) + 1]);
            ASSERT_LE(std::abs(at(y, row) - sum), 1e-4) << row;
          }
          for (std::size_t c = 0; c < columns; ++c) {
            Complex sum = 0;
            for (std::size_t row = 0; row < rows; ++row)
              sum += entry(row, c) * at(x, row);
            ASSERT_LE(std::abs(Complex(dots[2 * (c * count + v)], dots[2 * (c * count + v) + 1]) - sum), 1e-4);
          }
        }
      }
    }
  }
}

TEST(ClusterTree, CoversTheMatrixOnceAndKeepsNearPairsWhole) {
  // One end of the body has far larger faces than the other.
  const geometry::Mesh mesh = test::transformed(geometry::icosphere(8e-3, 10),
                                                [](const Vec3& p) { return Vec3(p.x, p.y, p.z * (p.z > 0 ? 4 : 1)); });
  const ClusterTree tree = cluster_tree(mesh, 32);
  const std::size_t size = mesh.positions.size();
  std::vector<std::uint32_t> sorted = tree.order;
  std::ranges::sort(sorted);
  for (std::uint32_t i = 0; i < size; ++i)
    ASSERT_EQ(sorted[i], i);
  for (const Cluster& cluster : tree.clusters) {
    EXPECT_EQ(cluster.begin % cluster_lanes, 0u);
    EXPECT_EQ(cluster.leaf(), cluster.size() <= 32);
    if (cluster.leaf()) continue;
    EXPECT_EQ(tree.clusters[cluster.first].begin, cluster.begin);
    EXPECT_EQ(tree.clusters[cluster.first].end, tree.clusters[cluster.second].begin);
    EXPECT_EQ(tree.clusters[cluster.second].end, cluster.end);
  }
  std::vector<std::uint8_t> covered(size * size), far(size * size);
  std::size_t far_blocks = 0;
  for (const BlockPlace& place : block_places(tree, 4)) {
    far_blocks += place.far;
    const Cluster &rows = tree.clusters[place.rows], &columns = tree.clusters[place.columns];
    for (std::uint32_t i = rows.begin; i < rows.end; ++i) {
      for (std::uint32_t j = columns.begin; j < columns.end; ++j) {
        const std::size_t entry = tree.order[i] * size + tree.order[j];
        ++covered[entry];
        far[entry] = place.far;
      }
    }
  }
  EXPECT_GT(far_blocks, 10u);
  EXPECT_TRUE(std::ranges::all_of(covered, [](std::uint8_t times) { return times == 1; }));
  const NearPairs near = near_pairs(make_patches(mesh), k);
  for (std::uint32_t test = 0; test + 1 < near.first.size(); ++test) {
    for (std::uint32_t at = near.first[test]; at < near.first[test + 1]; ++at) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
          ASSERT_FALSE(far[mesh.triangles[test][i] * size + mesh.triangles[near.trial[at]][j]]);
      }
    }
  }
}

/// Blocks of the matrix in split form, and the whole matrix.
struct Parts {
  explicit Parts(const geometry::Mesh& mesh)
      : body(make_patches(mesh)),
        size(mesh.positions.size()),
        tree(cluster_tree(mesh, 32)),
        entries(body, tree, k, near_pairs(body, k)),
        whole(size * size) {
    assemble(body, k, whole);
  }
  Complex entry(const Cluster& rows, std::size_t i, const Cluster& columns, std::size_t j) const {
    return whole[tree.order[rows.begin + i] * size + tree.order[columns.begin + j]];
  }

  Patches body;
  std::size_t size;
  ClusterTree tree;
  MatrixEntries entries;
  std::vector<std::complex<float>> whole;
};

double error_of(const Parts& parts, const BlockPlace& place, const LowRank& product) {
  const Cluster &a = parts.tree.clusters[place.rows], &b = parts.tree.clusters[place.columns];
  const std::size_t left = split_stride(a.size()), right = split_stride(b.size());
  Deviation off;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      Complex sum = 0;
      for (std::size_t r = 0; r < product.rank; ++r) {
        sum += Complex(product.left[2 * left * r + i], product.left[2 * left * r + left + i]) *
               Complex(product.right[2 * right * r + j], product.right[2 * right * r + right + j]);
      }
      off.add(sum, parts.entry(a, i, b, j));
    }
  }
  return off.relative();
}

TEST(LowRank, IsAsExactAsAskedFor) {
  // On the box, some rows of a block vanish on a part of the columns in one of the equation's halves.
  const geometry::Mesh ball = geometry::icosphere(8e-3, 8),
                       edges = test::transformed(ball, [](const Vec3&p) {
                         return 8e-3 / std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) * p;
                       });
  for (const geometry::Mesh& mesh : {ball, edges}) {
    const Parts parts(mesh);
    ClusterPatches rows, columns;
    std::size_t blocks = 0, ranks[2] = {};
    for (const BlockPlace& place : block_places(parts.tree, 4)) {
      if (!place.far) continue;
      parts.entries.select(parts.tree.clusters[place.rows], rows);
      parts.entries.select(parts.tree.clusters[place.columns], columns);
      LowRank product;
      for (const int fine : {0, 1}) {
        const double tolerance = fine ? 1e-4 : 1e-2;
        ASSERT_TRUE(approximate(parts.entries, rows, columns, tolerance, 32, product));
        EXPECT_LT(error_of(parts, place, product), 3 * tolerance);
        ranks[fine] += product.rank;
      }
      EXPECT_FALSE(approximate(parts.entries, rows, columns, 1e-4, 2, product));
      ++blocks;
    }
    EXPECT_GT(blocks, 50u);
    EXPECT_LT(ranks[0], ranks[1]);
    EXPECT_LT(ranks[1], 20 * blocks);
  }
}

TEST(HierarchicalMatrix, MultipliesAsTheWholeMatrix) {
  const geometry::Mesh mesh = geometry::icosphere(8e-3, 9);
  const Patches body = make_patches(mesh);
  const HierarchicalMatrix matrix(body, k, 1e-4);
  const std::size_t size = mesh.positions.size(), stride = matrix.stride();
  std::vector<std::complex<float>> whole(size * size);
  assemble(body, k, whole);
  constexpr std::size_t count = 3;
  std::vector<float> x(2 * stride * count), y(x.size(), 9);
  const std::vector<float> numbers = noise(2 * size * count, 4);
  for (std::size_t v = 0; v < 2 * count; ++v)
    std::copy_n(&numbers[v * size], size, &x[v * stride]);
  for (const Way way : {Way::forth, Way::back}) {
    matrix.multiply(way, {x.data(), stride}, count, {y.data(), stride});
    Deviation off;
    for (std::size_t v = 0; v < count; ++v) {
      for (std::size_t i = 0; i < size; ++i) {
        Complex sum = 0;
        for (std::size_t j = 0; j < size; ++j) {
          const std::size_t a = matrix.order()[i], b = matrix.order()[j];
          sum += Complex(way == Way::forth ? whole[a * size + b] : whole[b * size + a]) *
                 Complex(x[2 * stride * v + j], x[2 * stride * v + stride + j]);
        }
        off.add(Complex(y[2 * stride * v + i], y[2 * stride * v + stride + i]), sum);
      }
    }
    EXPECT_LT(off.relative(), 2e-4);
  }
  for (const auto& square : matrix.squares(128)) {
    const std::size_t wide = square.end - square.begin;
    ASSERT_LE(wide, 128u);
    const auto found = matrix.entries(square);
    Deviation off;
    for (std::size_t i = 0; i < wide; ++i) {
      for (std::size_t j = 0; j < wide; ++j)
        off.add(found[i * wide + j], whole[matrix.order()[square.begin + i] * size + matrix.order()[square.begin + j]]);
    }
    EXPECT_LT(off.relative(), 1e-4);
  }
}

}  // namespace
}  // namespace palpa::acoustics
