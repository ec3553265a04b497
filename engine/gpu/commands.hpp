// Recording and submitting. A Recorder is one command buffer that is re-recorded for every frame; a Timeline is the
// semaphore that shows the device's progress. Nothing here ever waits for an idle device.
#pragma once

#include <volk.h>

#include <cstdint>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// One primary command buffer with its own pool. It may be re-recorded once the submit that used it has completed.
class Recorder {
 public:
  Recorder() = default;
  Recorder(const Device& device, const char* name);

  VkCommandBuffer begin() const;
  /// Ends recording; pass the result to Timeline::submit.
  VkCommandBuffer end() const;

 private:
  const Device* device_ = nullptr;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

/// A timeline semaphore: submit number n signals the value n. Submits of one timeline complete in order.
class Timeline {
 public:
  explicit Timeline(const Device& device, const char* name = "timeline");
  /// Waits for all submits in progress, so that everything they use may then be destroyed. Members that a submit uses
  /// must therefore be declared before their Timeline.
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// Submits to the device's queue and returns the value that its completion signals. Without `commands`, the value is
  /// signalled when everything that was submitted to the queue before, by any code, is complete.
  std::uint64_t submit(VkCommandBuffer commands = VK_NULL_HANDLE);
  /// Blocks until `value` is signalled. Throws Error (Exit::failed) if the device is lost, or if it does not finish
  /// within `timeout_s` (for a software device: seconds of processor time, gpu/patience.hpp). After such a timeout the
  /// device counts as lost and as abandoned (gpu/handle.hpp).
  void wait(std::uint64_t value, double timeout_s = 60.0) const;
  bool done(std::uint64_t value) const;
  /// The value of the newest submit.
  std::uint64_t last() const { return last_; }

 private:
  const Device* device_;
  Handle<VkSemaphore> semaphore_;
  std::uint64_t last_ = 0;
};

}  // namespace palpa::gpu
