// Exclusive prefix sum of the counts that the workgroups of a compaction found. Compaction by prefix sum keeps the
// input's order, so its output is the same on every run, in whatever order workgroups ran.
#pragma once

#include <cstdint>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/shared/scan.h"

namespace palpa::gpu {

/// 64 items per group, without a limit on groups.
inline constexpr shader::ScanGroups groups_of_64{64, 0, 0xffffffffu, 1};

struct ScanBindings {
  BufferRef counts;       ///< in, out: uint32 each, replaced by the sum of the counts before it
  BufferRef length = {};  ///< in: uint32, see record()
  BufferRef total;        ///< out: shader::ScanTotal
};

/// Holds only pipelines; the caller owns buffers and command buffer.
class ScanPass {
 public:
  explicit ScanPass(const Device& device);

  /// How many counts there are, and how the dispatch over the sum is divided.
  struct Sizes {
    std::uint32_t most_counts = 0;
    std::uint32_t items_per_count = 1;
    std::uint32_t most_total = 0xffffffffu;
    shader::ScanGroups groups = groups_of_64;
  };
  /// Works in place on `counts` (at most `most_counts` and at most the buffer's size). With `length`, the number of
  /// counts is ceil(length[0] / items_per_count), read on the device and bounded by `most_counts`; an empty BufferRef
  /// means exactly `most_counts`. Writes a ScanTotal to `total`: the sum, clamped to `most_total`, and the three group
  /// counts of an indirect dispatch that is divided as `groups` says. Barriers: expects counts and length to be visible
  /// to compute; the caller adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, ScanBindings bindings, const Sizes& sizes) const;

 private:
  ComputePipeline pipeline_;
};

}  // namespace palpa::gpu
