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
  BufferRef counts;   ///< in: uint32 each
  BufferRef offsets;  ///< out: uint32 each, the sum of the counts before it
  BufferRef total;    ///< out: shader::ScanTotal
};

/// Holds only pipelines; the caller owns buffers and command buffer.
class ScanPass {
 public:
  explicit ScanPass(const Device& device);

  /// How many counts there are, and how the dispatch over the sum is divided.
  struct Sizes {
    std::uint32_t counts = 0;
    std::uint32_t most_total = 0xffffffffu;
    shader::ScanGroups groups = groups_of_64;
  };
  /// Reads the first `counts` counts and writes as many offsets, in another buffer. Writes a ScanTotal to `total`: the
  /// sum, clamped to `most_total`, and the three group counts of an indirect dispatch that is divided as `groups` says.
  /// Barriers: expects counts to be visible to compute; the caller adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const ScanBindings& bindings, const Sizes& sizes) const;

 private:
  ComputePipeline pipeline_;
};

}  // namespace palpa::gpu
