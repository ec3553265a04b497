// Fingers of the frame before, on the device: which clusters of this frame are fingers, and what the next frame has to
// know of them. The rules are in admit_twin.hpp and keep_twin.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "shaders/touch/known/known.h"
#include "touch/bridge/known_labels.hpp"
#include "touch/room.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The fingers of the frame before. One object serves all frames in flight, as with TracksMemory.
class KnownMemory {
 public:
  explicit KnownMemory(const gpu::Device& device) : known_(device, sizeof(shader::KnownTable), "known fingers") {}
  gpu::BufferRef ref() const { return known_.ref(); }

 private:
  gpu::Buffer known_;  // needs no initial value: the first frame does not read it
};

struct KnownBindings {
  gpu::BufferRef depth;        ///< in: packed by sensing::pack_depth
  gpu::BufferRef rays;         ///< in: sensing::upload_rays
  gpu::BufferRef cameras;      ///< in: bridge_cameras(), one shader::BridgeCamera each
  gpu::BufferRef total;        ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef contacts;     ///< in: shader::ContactRecord[]
  gpu::BufferRef parents;      ///< in: as BridgePass leaves it
  gpu::BufferRef header;       ///< in, out: shader::TouchHeader
  gpu::BufferRef fingers;      ///< in, out: shader::FingerRecord[max_fingers]
  gpu::BufferRef known;        ///< in, out: shader::KnownTable
  gpu::BufferRef tracks = {};  ///< in, for keep() only: shader::TrackTable of this frame, from FollowPass
};

/// Pipelines only.
class KnownPass {
 public:
  explicit KnownPass(const gpu::Device& device);

  static std::vector<gpu::ScratchBuffer> scratch();

  /// Two dispatches: claim, admit. Barriers: all inputs must be visible to compute and as indirect arguments. Adds the
  /// inner barrier itself; the caller adds compute_to_compute afterwards.
  void admit(VkCommandBuffer commands, const KnownBindings& bindings, const gpu::Scratch& scratch, const Room& room,
             const Parameters& parameters, const KnownFrame& frame) const;
  /// One dispatch, after FollowPass, with the scratch of admit(). Frames are submitted to one queue in the order of
  /// these calls. Barriers: as for admit().
  void keep(VkCommandBuffer commands, const KnownBindings& bindings, const gpu::Scratch& scratch, const Room& room,
            const Parameters& parameters, const KnownFrame& frame) const;

 private:
  enum ScratchIndex : std::size_t { claims, scratch_count };

  gpu::ComputePipeline claim_, admit_, keep_;
};

}  // namespace palpa::touch
