// Fingers keep their identity, and their axes, from frame to frame. The rules are in docs/touch.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/follow.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// Microseconds from frame to frame, as following wants them.
class FrameClock {
 public:
  /// From the frame of the call before to this one's capture time; follow_anew for the first. A time before the
  /// one before is a new beginning: longer than any finger is remembered.
  std::uint32_t elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

/// The fingers of the frames before, for the twin. One for each stream of frames.
struct Tracks {
  FrameClock clock;
  std::uint32_t count = 0;
  std::uint32_t next_id = 0;
  std::array<shader::Track, shader::follow_most_tracks> tracks{};
};

/// C++ twin of FollowPass. Gives the first `finger_count` fingers of a frame, whose sections are those of find_frames,
/// their ids, and turns their axes the least they can from those of the frame before. Ids count up from 0 in the order
/// of the fingers and are never used twice. In the first frame ids are the fingers' order and axes stay as they are.
/// Same single-precision arithmetic as in the pass. Allocates nothing.
void follow_fingers(Tracks& tracks, double time_s, Touch& touch);

/// The same memory on the device: one for all frames in flight, which the queue works through in order.
class TrackBuffer {
 public:
  explicit TrackBuffer(const gpu::Device& device) : tracks_(device, sizeof(shader::TrackTable), "tracks") {}
  gpu::BufferRef ref() const { return tracks_.ref(); }
  FrameClock clock;

 private:
  gpu::Buffer tracks_;  // needs no first value: the first frame does not look at it
};

struct FollowBuffers {
  gpu::BufferRef header;   ///< in: shader::TouchHeader
  gpu::BufferRef fingers;  ///< in: shader::FingerRecord[max_fingers] with frames; out: id, steady axes, turn
  gpu::BufferRef tracks;   ///< in, out: shader::TrackTable
};

/// Pipelines only; one dispatch of a single group.
class FollowPass {
 public:
  explicit FollowPass(const gpu::Device& device);

  /// `elapsed_us` from the TrackBuffer's clock, for the frame that is being recorded; frames are submitted to one queue
  /// in the order of these calls.
  /// Barriers: expects header and fingers to be visible to compute; since pipeline barriers reach back over earlier
  /// submits to the queue, the same compute_to_compute orders the frames' use of `tracks`. The caller adds its own
  /// afterwards.
  void record(VkCommandBuffer commands, const FollowBuffers& buffers, std::uint32_t elapsed_us) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace palpa::touch
