// Storage buffers as a pipeline binds them: pushed with each draw, so that nothing needs to be allocated or kept alive.
#pragma once

#include <volk.h>

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// Set 0 of a pipeline layout: `count` storage buffers at bindings 0..count-1.
class BufferSet {
 public:
  BufferSet() = default;
  BufferSet(const Device& device, std::uint32_t count, VkShaderStageFlags stages);

  VkDescriptorSetLayout layout() const { return layout_.get(); }
  /// `buffers` in binding order, exactly `count` of them.
  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipelineLayout layout,
            std::initializer_list<BufferRef> buffers) const;

 private:
  Handle<VkDescriptorSetLayout> layout_;
  std::uint32_t count_ = 0;

  // GPU-assisted validation cannot see pushed descriptors. Under that preset alone, draws take turns in a ring of
  // ordinary sets, far longer than the draws of one pipeline that can be in flight.
  Handle<VkDescriptorPool> ring_pool_;
  std::vector<VkDescriptorSet> ring_;
  mutable std::size_t ring_next_ = 0;
  VkDevice device_ = VK_NULL_HANDLE;
};

}  // namespace palpa::gpu
