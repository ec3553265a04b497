#include "acoustics/boundary/galerkin.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "acoustics/boundary/far_tables.hpp"
#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/boundary/near_pairs.hpp"
#include "base/activity.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/bvh.hpp"

namespace palpa::acoustics {
namespace {

/// Rows of the matrix that one thread fills at once. Patches around the rim of these vertices are also evaluated by
/// their neighbours, which costs less than sharing rows.
constexpr std::size_t rows_per_block = 96;

struct FarTables {
  std::vector<FarPatch> patches;
  std::vector<FarGroup> groups;
};

FarTables far_tables(const Patches& body) {
  FarTables tables{far_patches(body, geometry::bounds(body.mesh).centre()), {}};
  std::vector<std::uint32_t> all(tables.patches.size());
  std::iota(all.begin(), all.end(), 0u);
  gather(tables.patches, all, tables.groups);
  return tables;
}

/// The vertices in an order that keeps spatial neighbours close to each other.
std::vector<std::uint32_t> spatial_order(const geometry::Mesh& mesh) {
  std::vector<std::uint32_t> order;
  order.reserve(mesh.positions.size());
  std::vector<std::uint8_t> taken(mesh.positions.size());
  const geometry::Bvh bvh(mesh);
  for (const std::uint32_t t : bvh.order()) {
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = mesh.triangles[t][c];
      if (!taken[v]) order.push_back(v);
      taken[v] = 1;
    }
  }
  return order;
}

/// The rows of some vertices: all patches around them against all patches.
class RowBlock {
 public:
  RowBlock(const Patches& body, const Around& around, std::span<const std::uint32_t> vertices,
           std::span<std::complex<float>> matrix)
      : mesh_(body.mesh), size_(body.mesh.positions.size()), rows_(size_, nullptr) {
    for (const std::uint32_t v : vertices) {
      rows_[v] = &matrix[v * size_];
      std::fill_n(rows_[v], size_, std::complex<float>{});
      tests_.insert(tests_.end(), around.of(v).begin(), around.of(v).end());
    }
    std::sort(tests_.begin(), tests_.end());
    tests_.erase(std::unique(tests_.begin(), tests_.end()), tests_.end());
  }

  void fill(const FarTables& far, const NearPairs& near, float wave_number, const std::atomic<bool>* give_up) {
    std::vector<std::uint32_t> next(tests_.size());
    for (std::size_t i = 0; i < tests_.size(); ++i)
      next[i] = near.first[tests_[i]];
    FarBlocks blocks;
    for (std::size_t group = 0; group < far.groups.size(); ++group) {
      stop_if(give_up);
      for (std::size_t i = 0; i < tests_.size(); ++i) {
        far_blocks(far.patches[tests_[i]], far.groups[group], wave_number, blocks);
        add_group(near, tests_[i], group, next[i], blocks);
      }
    }
  }

 private:
  void add_group(const NearPairs& near, std::uint32_t test, std::size_t group, std::uint32_t& next,
                 const FarBlocks& blocks) {
    const auto begin = static_cast<std::uint32_t>(group * far_lanes);
    const auto end = static_cast<std::uint32_t>(std::min(mesh_.triangles.size(), (group + 1) * far_lanes));
    const std::uint32_t last = near.first[test + 1];
    for (std::uint32_t trial = begin; trial < end; ++trial) {
      const std::size_t lane = trial - begin;
      const bool close = next < last && near.trial[next] == trial;
      for (std::size_t i = 0; i < 3; ++i) {
        std::complex<float>* const row = rows_[mesh_.triangles[test][static_cast<int>(i)]];
        if (row == nullptr) continue;
        for (std::size_t j = 0; j < 3; ++j) {
          const std::size_t entry = 3 * i + j;
          row[mesh_.triangles[trial][static_cast<int>(j)]] +=
              close ? near.blocks[next][entry]
                    : std::complex<float>(blocks.of[entry][0][lane], blocks.of[entry][1][lane]);
        }
      }
      next += close;
    }
  }

  const geometry::Mesh& mesh_;
  std::size_t size_;
  std::vector<std::complex<float>*> rows_;  // by vertex; null for those of other blocks
  std::vector<std::uint32_t> tests_;
};

}  // namespace

void assemble(const Patches& body, double wave_number, std::span<std::complex<float>> matrix,
              const std::atomic<bool>* give_up) {
  const FarTables far = far_tables(body);
  const NearPairs near = near_pairs(body, wave_number, give_up);
  warn_of_unresolved(near);
  const Around around = patches_around(body.mesh);
  const std::vector<std::uint32_t> order = spatial_order(body.mesh);
  Activity activity("filling the matrix of the surface", order.size());
  parallel_chunks(order.size(), rows_per_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    RowBlock(body, around, std::span(order).subspan(begin, end - begin), matrix)
        .fill(far, near, static_cast<float>(wave_number), give_up);
    activity.advance(end - begin);
  });
}

std::uint64_t assembly_bytes(const geometry::Mesh& mesh) {
  // While pairs are searched, a pair's number is in memory twice.
  return mesh.triangles.size() * (sizeof(FarPatch) + sizeof(FarGroup) / far_lanes) +
         near_pair_count(mesh) * (sizeof(Block) + 2 * sizeof(std::uint32_t));
}

}  // namespace palpa::acoustics
