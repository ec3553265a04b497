// The time of each pass, measured on the device.
#pragma once

#include <volk.h>

#include <cstdint>
#include <vector>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "gpu/pass_time.hpp"

namespace palpa::gpu {

/// The marks of one command buffer. Call `begin`, then `mark` after each pass, and `read` once the submit has
/// completed.
class Timestamps {
 public:
  Timestamps() = default;
  Timestamps(const Device& device, std::uint32_t most_marks);

  void begin(VkCommandBuffer commands);
  /// Ends the pass `name` (a string literal, kept by pointer), which began at the previous mark.
  void mark(VkCommandBuffer commands, const char* name);
  /// Replaces `out` with the times of the passes in the order of their marks; several marks with the same name add up.
  void read(std::vector<PassTime>& out) const;

 private:
  const Device* device_ = nullptr;
  Handle<VkQueryPool> pool_;
  std::vector<const char*> names_;
  mutable std::vector<std::uint64_t> ticks_;
};

}  // namespace palpa::gpu
