// Hidden skin on the device: if no camera sees the underside of a fingertip, the patches of contacts on its two sides
// are joined to one finger. The rules are in bridge_twin.hpp.
#pragma once

#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "touch/bridge/known_labels.hpp"
#include "touch/room.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

struct BridgeBindings {
  gpu::BufferRef depth;     ///< in: packed by sensing::pack_depth
  gpu::BufferRef rays;      ///< in: sensing::upload_rays
  gpu::BufferRef cameras;   ///< in: bridge_cameras(), one shader::BridgeCamera each
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]
  gpu::BufferRef parents;   ///< in, out: as FingersPass leaves it; joined patches get the same number
  gpu::BufferRef clusters;  ///< in, out: as FingersPass leaves it
  gpu::BufferRef header;    ///< in, out: shader::TouchHeader
  gpu::BufferRef fingers;   ///< in, out: shader::FingerRecord[max_fingers]
  gpu::BufferRef known;     ///< in, out (doubts): shader::KnownTable, not used if there is no frame before
};

/// Pipelines only; four dispatches: sample, pairs, join, relabel. With fewer than two fingers, no dispatch runs a
/// group.
class BridgePass {
 public:
  explicit BridgePass(const gpu::Device& device);

  static std::vector<gpu::ScratchBuffer> scratch();

  /// Barriers: all inputs must be visible to compute and as indirect arguments. Adds the inner barriers itself; the
  /// caller adds compute_to_compute afterwards.
  void record(VkCommandBuffer commands, const BridgeBindings& bindings, const gpu::Scratch& scratch, const Room& room,
              const Parameters& parameters, const KnownFrame& known) const;

 private:
  enum ScratchIndex : std::size_t { samples, patches, pairs, scratch_count };

  gpu::ComputePipeline sample_, pairs_, join_, relabel_;
};

}  // namespace palpa::touch
