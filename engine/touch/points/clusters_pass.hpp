// Clusters on the device: exact Euclidean clusters of each solid's contacts. Two contacts of one solid that are no
// farther apart than the finger gap are in one cluster, and so are all contacts that such steps connect. A cluster of
// at least min_points may be a finger.
//
// Method: the cells are so small that all contacts of one cell are in one cluster (Wang, Gu, Shun 2020). There are
// eight cells to a block and eight blocks to a tile; the tiles are in a hash table. Cells that hold contacts are
// numbered tile by tile. Pairs of contacts are tested only between cells of blocks that touch, up to the first hit. A
// lock-free union-find over cells joins them (after Jaiganesh and Burtscher's ECL-CC, HPDC 2018).
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "touch/capacity.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

struct ClustersBindings {
  gpu::BufferRef length;    ///< in: shader::ScanTotal of the skin points, for the header only
  gpu::BufferRef solids;    ///< in: shader::SolidRecord[], with a view of R32G32B32A32_SFLOAT texels
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[], with a view of R32G32B32A32_UINT texels
  /// out: per clustered point (capacity.clustered()), a number that is unique to its cluster (not the same on every
  /// run)
  gpu::BufferRef parents;
  gpu::BufferRef clusters;  ///< out: shader::Cluster per clustered point, valid at a cluster's number
  gpu::BufferRef header;    ///< out: shader::TouchHeader
  gpu::BufferRef selected;  ///< out: shader::ClusterRecord[max_fingers]: the clusters that may be fingers
  // Needed only for Cluster::inside.
  gpu::BufferRef deep_total = {};  ///< in: shader::ScanTotal of the deep points
  gpu::BufferRef deep = {};        ///< in: shader::ContactRecord[]
};

/// Pipelines only; eleven dispatches: prepare, insert, collect, place, blocks, link, crowded, link again for all
/// pairs (`rest_`), undecided, label, select. For Cluster::inside, gather runs before them. Every loop is bounded. The
/// clusters do not depend on the order of execution. A software device, which counts a shader's iterations, finds exact
/// clusters unless more than 20,000 contacts lie in a cube whose side is the gap, and as many beside it.
class ClustersPass {
 public:
  explicit ClustersPass(const gpu::Device& device) : device_(&device) {}

  /// Makes the pipelines that record() uses for these parameters; existing pipelines are kept.
  void prepare(const FingerOptions& parameters);

  static std::vector<gpu::ScratchBuffer> scratch(const Capacity& capacity);

  /// Barriers: total and contacts must be visible to compute and as indirect arguments. Adds the inner barriers itself;
  /// the caller adds compute_to_compute afterwards. The parameters must pass check_parameters(). With `times`, marks
  /// "cells", "links" and "clusters".
  void record(VkCommandBuffer commands, const ClustersBindings& bindings, const gpu::Scratch& scratch,
              const Capacity& capacity, const FingerOptions& parameters, gpu::Timestamps* times = nullptr) const;

 private:
  enum ScratchIndex : std::size_t {
    nodes,
    tiles,
    bases,
    places,
    list,
    links,
    groups,
    crowded,
    work,
    forest,
    inside_total,
    inside_points,
    scratch_count
  };

  const gpu::Device* device_;
  gpu::ComputePipeline gather_, label_inside_, prepare_, insert_, collect_, place_, blocks_, link_, crowded_, rest_,
      undecided_, label_, select_;
};

}  // namespace palpa::touch
