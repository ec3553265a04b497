// What a test may see of the commands that are recorded, to find missing barriers (tests/support/barriers.hpp).
// Programs watch nothing.
#pragma once

#include <volk.h>

#include <atomic>

#include "gpu/kernel.hpp"

namespace palpa::gpu {

/// Its functions are called by any thread, before the command is recorded. What one throws, the recording throws.
class Watch {
 public:
  virtual ~Watch() = default;
  virtual void begins(VkCommandBuffer commands) = 0;
  /// `groups`: the group counts of an indirect dispatch, otherwise null.
  virtual void dispatches(VkCommandBuffer commands, const KernelBuffers& buffers, const BufferRef* groups) = 0;
  /// Commands of stage `from` before this end before those of stage `to` after it.
  virtual void orders(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkPipelineStageFlags2 to) = 0;
  /// A copy, or the host after the submit, reads or writes `buffer` in stage `where`. `who` outlives the recording.
  virtual void uses(VkCommandBuffer commands, const char* who, const BufferRef& buffer, VkPipelineStageFlags2 where,
                    bool writes) = 0;
};

/// Null: nobody watches. Set it before anything is recorded.
inline std::atomic<Watch*> watch{nullptr};

}  // namespace palpa::gpu
