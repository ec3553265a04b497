// On the device: splits clusters that are several fingers side by side, and drops clusters that are no finger. The
// rules are in split_twin.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "shaders/touch/split/split.h"
#include "touch/bridge/known_labels.hpp"
#include "touch/room.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The number of cluster records for parts, in addition to the records of the clusters.
inline constexpr std::uint32_t split_clusters = max_fingers * shader::split_numbers;

struct SplitBindings {
  gpu::BufferRef depth;     ///< in: packed by sensing::pack_depth
  gpu::BufferRef rays;      ///< in: sensing::upload_rays
  gpu::BufferRef cameras;   ///< in: bridge_cameras(), one shader::BridgeCamera each
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]
  gpu::BufferRef parents;   ///< in, out: as FingersPass leaves it; contacts of a part get a number above room.contacts
  gpu::BufferRef clusters;  ///< in, out: as FingersPass leaves it, plus split_clusters more above room.contacts
  gpu::BufferRef header;    ///< in, out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< in, out: shader::FingerRecord[max_fingers]: first, solid and contacts
  gpu::BufferRef known;     ///< in, out (doubts): shader::KnownTable, not used if there is no frame before
};

/// Pipelines only; five dispatches: sample, look, parts, assign, list. If every finger stays as it is, the last four
/// run no group.
class SplitPass {
 public:
  explicit SplitPass(const gpu::Device& device);

  static std::vector<gpu::ScratchBuffer> scratch();

  /// Barriers: all inputs must be visible to compute and as indirect arguments. Adds the inner barriers itself; the
  /// caller adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const SplitBindings& bindings, const gpu::Scratch& scratch, const Room& room,
              const Parameters& parameters, const KnownFrame& known) const;

 private:
  enum ScratchIndex : std::size_t { samples, states, evidence, labels, scratch_count };

  gpu::ComputePipeline sample_, look_, parts_, assign_, list_;
};

}  // namespace palpa::touch
