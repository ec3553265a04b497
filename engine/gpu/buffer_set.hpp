// The buffers of a pipeline. They are pushed with each dispatch or draw, so nothing has to be allocated or kept alive.
#pragma once

#include <volk.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// Set 0 of a pipeline layout: `count` buffers at bindings 0..count-1. Binding i is a uniform texel buffer if bit i of
/// `texels` is set, else a storage buffer.
class BufferSet {
 public:
  BufferSet() = default;
  /// At most 17 buffers, bound at most `most_uses` times by all submits in flight together. `name` is the pipeline's.
  /// Throws failure for more buffers.
  BufferSet(const Device& device, const char* name, std::uint32_t count, VkShaderStageFlags stages,
            std::uint32_t most_uses, std::uint32_t texels = 0);

  /// With a block of push constants of this size, or none if it is 0.
  Handle<VkPipelineLayout> pipeline_layout(const Device& device, std::uint32_t push_bytes) const;
  /// `buffers`: exactly `count`, in binding order, not null. Those read as texels must have a texel view.
  /// Throws failure otherwise.
  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipelineLayout layout,
            std::span<const BufferRef> buffers) const;

 private:
  VkDescriptorType type(std::uint32_t binding) const;

  Handle<VkDescriptorSetLayout> layout_;
  std::string name_;
  VkShaderStageFlags stages_ = 0;
  std::uint32_t count_ = 0, texels_ = 0;

  // GPU-assisted validation cannot see pushed descriptors. Only under that preset, binds cycle through a ring of
  // `most_uses` ordinary sets.
  Handle<VkDescriptorPool> ring_pool_;
  std::vector<VkDescriptorSet> ring_;
  mutable std::size_t ring_next_ = 0;
  VkDevice device_ = VK_NULL_HANDLE;
};

}  // namespace palpa::gpu
