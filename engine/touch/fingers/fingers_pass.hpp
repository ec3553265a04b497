// Fingers on the device: exact Euclidean clusters of each solid's contacts. Two contacts of one solid no farther apart
// than the finger gap are in one cluster, and so is whatever hangs together through others; a cluster of at least
// min_points is a finger.
//
// Method: cells so small that all contacts of one cell are in one cluster (Wang, Gu, Shun 2020), eight to a block,
// eight blocks to a tile, tiles in a hash table; cells that hold contacts are numbered tile by tile. Pairs of contacts
// are tested only between cells of blocks that touch, up to the first hit; a lock-free union-find over cells joins them
// (after Jaiganesh and Burtscher's ECL-CC, HPDC 2018).
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "touch/room.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

struct FingersBindings {
  gpu::BufferRef length;    ///< in: shader::ScanTotal of the skin points, for the header only
  gpu::BufferRef solids;    ///< in: shader::SolidRecord[], with a view of R32G32B32A32_SFLOAT texels
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[], with a view of R32G32B32A32_UINT texels
  /// out: per clustered point (room.clustered()) a number that its cluster alone has (not the same on every run)
  gpu::BufferRef parents;
  gpu::BufferRef clusters;  ///< out: shader::Cluster per clustered point, valid where that is its cluster's number
  gpu::BufferRef header;    ///< out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< out: shader::FingerRecord[max_fingers], first, solid and contacts
  // Only for Cluster::inside.
  gpu::BufferRef deep_total = {};  ///< in: shader::ScanTotal of the deep points
  gpu::BufferRef deep = {};        ///< in: shader::ContactRecord[]
};

/// Pipelines only; eleven dispatches, and gather before them for Cluster::inside: prepare, insert, collect, place,
/// blocks, link, crowded, rest, undecided, label, select. Every loop is bounded; the fingers do not depend on the order
/// in which anything ran. A software device, which counts a shader's iterations, finds them exactly unless more than
/// 20,000 contacts lie in a cube with sides of a gap, and as many beside it.
class FingersPass {
 public:
  explicit FingersPass(const gpu::Device& device) : device_(&device) {}

  /// Makes the pipelines that record() takes for these; those that are there stay.
  void prepare(const Parameters& parameters);

  static std::vector<gpu::ScratchBuffer> scratch(const Room& room);

  /// Barriers: expects total and contacts to be visible to compute and as indirect arguments; adds its own inside; the
  /// caller adds compute_to_compute afterwards. Expects what check_parameters() accepts. With `times`, marks "cells",
  /// "links" and "fingers".
  void record(VkCommandBuffer commands, const FingersBindings& bindings, const gpu::Scratch& scratch, const Room& room,
              const Parameters& parameters, gpu::Timestamps* times = nullptr) const;

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
