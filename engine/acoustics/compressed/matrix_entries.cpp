#include "acoustics/compressed/matrix_entries.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace palpa::acoustics {

MatrixEntries::MatrixEntries(const Patches& body, const ClusterTree& tree, double wave_number, NearPairs near)
    : body_(body),
      tree_(tree),
      wave_number_(static_cast<float>(wave_number)),
      near_(std::move(near)),
      far_(far_patches(body, tree.clusters.front().box.centre())),
      around_(patches_around(body.mesh)),
      place_of_(tree.order.size()) {
  for (std::uint32_t place = 0; place < tree.order.size(); ++place)
    place_of_[tree.order[place]] = place;
}

void MatrixEntries::select(const Cluster& cluster, ClusterPatches& out) const {
  out.begin = cluster.begin;
  out.size = cluster.size();
  out.patches.clear();
  for (std::uint32_t place = cluster.begin; place < cluster.end; ++place) {
    const auto around = around_.of(tree_.order[place]);
    out.patches.insert(out.patches.end(), around.begin(), around.end());
  }
  std::sort(out.patches.begin(), out.patches.end());
  out.patches.erase(std::unique(out.patches.begin(), out.patches.end()), out.patches.end());
  gather(far_, out.patches, out.groups);
  out.corners.resize(out.patches.size());
  for (std::size_t i = 0; i < out.patches.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t place = place_of_[body_.mesh.triangles[out.patches[i]][static_cast<int>(c)]];
      out.corners[i][c] = place >= cluster.begin && place < cluster.end ? place - cluster.begin : out.size;
    }
  }
}

void MatrixEntries::hat_at(std::uint32_t place, std::vector<HatSample>& hat) const {
  hat.clear();
  const std::uint32_t vertex = tree_.order[place];
  for (const std::uint32_t t : around_.of(vertex)) {
    const glm::uvec3& corners = body_.mesh.triangles[t];
    const std::size_t corner = corners.x == vertex ? 0 : corners.y == vertex ? 1 : 2;
    for (std::size_t q = 0; q < 3; ++q) {
      const float(&x)[far_numbers] = far_[t].of[q];
      const float h = corner == q ? 2.0F / 3 : 1.0F / 6;
      HatSample sample{};
      sample.size = h * far_[t].area[q];
      for (std::size_t i = 0; i < 3; ++i) {
        sample.at[i] = x[far_x + i];
        sample.area[i] = h * x[far_area + i];
        sample.curl[i] = corner == 0 ? x[far_u + i] - x[far_v + i] : corner == 1 ? x[far_v + i] : -x[far_u + i];
      }
      hat.push_back(sample);
    }
  }
}

namespace {

void add_sums(const HatSums& sums, const ClusterPatches& patches, std::size_t group, SplitSpan out) {
  const std::size_t begin = group * far_lanes, end = std::min(patches.patches.size(), begin + far_lanes);
  for (std::size_t at = begin; at < end; ++at) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t place = patches.corners[at][c];
      if (place == patches.size) continue;
      out.re[place] += sums.of[c][0][at - begin];
      out.im[place] += sums.of[c][1][at - begin];
    }
  }
}

}  // namespace

void MatrixEntries::line(std::uint32_t place, const ClusterPatches& others, const HatKernel& kernel,
                         SplitSpan out) const {
  thread_local std::vector<HatSample> hat;
  hat_at(place, hat);
  std::fill_n(out.re, others.size, 0.0F);
  std::fill_n(out.im, others.size, 0.0F);
  HatSums sums;
  for (std::size_t group = 0; group < others.groups.size(); ++group) {
    kernel(hat, others.groups[group], wave_number_, sums);
    add_sums(sums, others, group, out);
  }
}

void MatrixEntries::row(std::uint32_t place, const ClusterPatches& columns, SplitSpan out) const {
  line(place, columns, hat_row, out);
}

void MatrixEntries::column(std::uint32_t place, const ClusterPatches& rows, SplitSpan out) const {
  line(place, rows, hat_column, out);
}

void MatrixEntries::block(const ClusterPatches& rows, const ClusterPatches& columns, std::size_t stride,
                          std::span<float> out) const {
  std::fill(out.begin(), out.end(), 0.0F);
  FarBlocks blocks;
  for (std::size_t test = 0; test < rows.patches.size(); ++test) {
    const std::uint32_t t = rows.patches[test];
    std::uint32_t next = near_.first[t];
    const std::uint32_t last = near_.first[t + 1];
    for (std::size_t group = 0; group < columns.groups.size(); ++group) {
      far_blocks(far_[t], columns.groups[group], wave_number_, blocks);
      const std::size_t begin = group * far_lanes, end = std::min(columns.patches.size(), begin + far_lanes);
      for (std::size_t trial = begin; trial < end; ++trial) {
        const std::uint32_t s = columns.patches[trial];
        while (next < last && near_.trial[next] < s)
          ++next;
        const bool close = next < last && near_.trial[next] == s;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t row = rows.corners[test][i];
          if (row == rows.size) continue;
          for (std::size_t j = 0; j < 3; ++j) {
            const std::uint32_t column = columns.corners[trial][j];
            if (column == columns.size) continue;
            const std::size_t entry = 3 * i + j;
            float* const at = &out[2 * stride * column + row];
            at[0] += close ? near_.blocks[next][entry].real() : blocks.of[entry][0][trial - begin];
            at[stride] += close ? near_.blocks[next][entry].imag() : blocks.of[entry][1][trial - begin];
          }
        }
      }
    }
  }
}

}  // namespace palpa::acoustics
