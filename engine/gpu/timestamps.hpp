// The time of every pass, measured on the device.
#pragma once

#include <volk.h>

#include <cstdint>
#include <vector>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

struct PassTime {
  const char* name;  ///< the literal given to mark()
  double ms;
};

/// Marks of one command buffer. `begin`, then one `mark` after each pass; `read` once the submit has completed.
class Timestamps {
 public:
  Timestamps() = default;
  Timestamps(const Device& device, std::uint32_t most_marks);

  void begin(VkCommandBuffer commands);
  /// Ends the pass `name` (a string literal, kept by pointer) that began at the mark before.
  void mark(VkCommandBuffer commands, const char* name);
  /// Replaces `out` by the passes' times in the order of their marks; several marks of one name add up.
  void read(std::vector<PassTime>& out) const;

 private:
  const Device* device_ = nullptr;
  Handle<VkQueryPool> pool_;
  std::vector<const char*> names_;
  mutable std::vector<std::uint64_t> ticks_;
};

}  // namespace palpa::gpu
