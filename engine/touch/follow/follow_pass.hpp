// Fingers keep their identity and their axes from frame to frame, on the device. The rules are in docs/touch.md.
#pragma once

#include <cstdint>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/touch/follow/follow.h"
#include "touch/follow/frame_clock.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The fingers of earlier frames. One object serves all frames in flight, because the queue processes them in order.
class TracksMemory {
 public:
  explicit TracksMemory(const gpu::Device& device) : tracks_(device, sizeof(shader::TrackTable), "tracks") {}
  gpu::BufferRef ref() const { return tracks_.ref(); }
  FrameClock clock;

 private:
  gpu::Buffer tracks_;  // needs no initial value: the first frame does not read it
};

struct FollowBindings {
  gpu::BufferRef header;   ///< in: shader::TouchHeader
  gpu::BufferRef fingers;  ///< in: shader::FingerRecord[max_fingers] with cross-sections; out: id, steady axes, turn
  gpu::BufferRef tracks;   ///< in, out: shader::TrackTable
};

/// Pipelines only; one dispatch of a single group.
class FollowPass {
 public:
  explicit FollowPass(const gpu::Device& device);

  /// `elapsed_us` comes from the TracksMemory's clock, for the frame that is being recorded. Frames are submitted to
  /// one queue in the order of these calls. Barriers: header and fingers must be visible to compute. Pipeline barriers
  /// also cover earlier submits to the queue, so the same compute_to_compute orders the frames' use of `tracks`. The
  /// caller adds the barriers afterwards.
  void record(VkCommandBuffer commands, const FollowBindings& bindings, std::uint32_t elapsed_us,
              const StageSetting& setting) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
