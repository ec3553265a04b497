// On the device: foci are smoothed so that they do not jump from frame to frame. The rules are in docs/touch.md.
#pragma once

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/touch/follow/glide.h"

namespace palpa::touch {

/// The data kept of fingers' foci, each at its track's home. One object serves all frames in flight, as with
/// TracksMemory.
class HomesMemory {
 public:
  explicit HomesMemory(const gpu::Device& device)
      : homes_(device, std::uint64_t{shader::follow_most_tracks} * sizeof(shader::Home), "homes") {}
  gpu::BufferRef ref() const { return homes_.ref(); }

 private:
  gpu::Buffer homes_;  // needs no initial value: a new finger does not read it
};

struct GlideBindings {
  gpu::BufferRef header;   ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef fingers;  ///< in: shader::FingerRecord[max_fingers] with foci; out: placed, held
  gpu::BufferRef tracks;   ///< in: shader::TrackTable of this frame, from FollowPass
  gpu::BufferRef foci;     ///< in, out: shader::FocusRecord[max_fingers * max_foci]
  gpu::BufferRef homes;    ///< in, out: shader::Home[follow_most_tracks]
};

/// Pipelines only; one dispatch.
class GlidePass {
 public:
  explicit GlidePass(const gpu::Device& device);

  /// The order of frames is as in FollowPass. Barriers: all inputs must be visible to compute and as indirect
  /// arguments. The caller adds the barriers afterwards.
  void record(VkCommandBuffer commands, const GlideBindings& bindings) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
