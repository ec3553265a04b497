// Cross-section frames of every finger, Eq. (2)-(4).
#pragma once

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/timestamps.hpp"
#include "shaders/frames.h"
#include "shaders/touch_math.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// A finger's contacts relative to its first one: the digits of single precision go to the finger's own size.
struct LocalFrame {
  shader::Float3 origin{}, mean{};
  shader::Float3 from_centroid(const glm::vec3& position) const {
    return minus(minus({position.x, position.y, position.z}, origin), mean);
  }
};
LocalFrame local_frame(const Finger& finger, const std::vector<Contact>& contacts);

/// C++ twin of FramesPass: fills section and point_like of the first `finger_count` fingers from their contacts, and
/// numbers their ids in order. Sums run in the pass's order with the same single-precision arithmetic: where a device
/// divides and takes roots exactly, results are the same bit for bit; elsewhere they differ by some units in the last
/// place.
void find_frames(Touch& out);

struct FramesBuffers {
  gpu::BufferRef total;     ///< in: shader::ScanTotal of the contacts
  gpu::BufferRef parents;   ///< in: per contact a number that its finger alone has
  gpu::BufferRef contacts;  ///< in: shader::ContactRecord[]; out: their `finger`
  gpu::BufferRef header;    ///< in: shader::TouchHeader, one group per finger
  gpu::BufferRef counts;    ///< scratch: 4 bytes for each of frames_most_chunks * max_fingers
  gpu::BufferRef grouped;   ///< out: 16 bytes per contact: bits of x, y, z, its number; finger after finger, in order
  gpu::BufferRef fingers;   ///< in: shader::FingerRecord[max_fingers] as FingersPass leaves it; out: frames
  std::uint32_t most_contacts = 0;
};

/// Pipelines only; three dispatches: count and group put the contacts in order of their fingers, whatever the number of
/// these at the same cost; axes looks at each finger's own.
class FramesPass {
 public:
  explicit FramesPass(const gpu::Device& device);

  /// Barriers: expects all inputs to be visible to compute and as indirect arguments; adds its own inside; the caller
  /// adds compute_to_compute afterwards. With `times`, marks "count", "group" and "frames".
  void record(VkCommandBuffer commands, const FramesBuffers& buffers, gpu::Timestamps* times = nullptr) const;

 private:
  gpu::ComputePipeline count_, group_, axes_;
};

}  // namespace palpa::touch
