// Hidden skin on the device: patches of contacts on two sides of one fingertip, its underside seen by no camera, are
// one finger. The rules stand in bridge_twin.hpp.
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "touch/room.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

struct BridgeBindings {
  gpu::BufferRef depth;     ///< in: packed by sensing::pack_depth
  gpu::BufferRef rays;      ///< in: sensing::upload_rays
  gpu::BufferRef cameras;   ///< in: bridge_cameras(), one shader::BridgeCamera each
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]
  gpu::BufferRef parents;   ///< in, out: as FingersPass leaves it; contacts of joined patches get one number
  gpu::BufferRef clusters;  ///< in, out: as FingersPass leaves it
  gpu::BufferRef header;    ///< in, out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< in, out: shader::FingerRecord[max_fingers]
};

/// Pipelines only; four dispatches: sample, pairs, join, relabel. With less than two fingers none has a group.
class BridgePass {
 public:
  explicit BridgePass(const gpu::Device& device);

  static std::vector<gpu::ScratchBuffer> scratch();

  /// Barriers: expects all inputs to be visible to compute and as indirect arguments; adds its own inside; the caller
  /// adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const BridgeBindings& bindings, const gpu::Scratch& scratch, const Room& room,
              const Parameters& parameters) const;

 private:
  enum ScratchIndex : std::size_t { samples, patches, pairs, scratch_count };

  gpu::ComputePipeline sample_, pairs_, join_, relabel_;
};

}  // namespace palpa::touch
