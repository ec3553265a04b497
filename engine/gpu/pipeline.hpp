// A compute pipeline whose buffers are pushed at each dispatch: no descriptor sets to allocate or keep alive.
#pragma once

#include <volk.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

#include "gpu/buffer.hpp"
#include "gpu/buffer_set.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "gpu/push.hpp"

namespace palpa::gpu {

/// Groups needed so that groups * group_size >= threads.
constexpr std::uint32_t groups_for(std::uint64_t threads, std::uint32_t group_size) {
  return static_cast<std::uint32_t>((threads + group_size - 1) / group_size);
}

/// Where a buffer holds the group counts of an indirect dispatch: a VkDispatchIndirectCommand `at` so many bytes.
inline BufferRef groups_in(const BufferRef& buffer, VkDeviceSize at = 0) {
  return {buffer.buffer, buffer.offset + at, sizeof(VkDispatchIndirectCommand)};
}

struct PipelineLayout {
  std::uint32_t buffers = 0;     ///< at set 0, bindings 0..buffers-1
  std::uint32_t push_bytes = 0;  ///< size of the push constant block, a multiple of 4, at most 128
  /// Values of the specialization constants with ids 0, 1, ...
  std::span<const std::uint32_t> constants = {};
  std::uint32_t texels = 0;  ///< bit i: binding i is a uniform texel buffer; the others are storage buffers
};

class ComputePipeline {
 public:
  /// None yet: false, and not to be dispatched.
  ComputePipeline() = default;
  /// `spirv` is one of the arrays of namespace palpa::spirv; the entry point is main.
  ComputePipeline(const Device& device, const char* name, std::span<const std::uint32_t> spirv,
                  const PipelineLayout& layout);
  explicit operator bool() const { return static_cast<bool>(pipeline_); }

  /// `buffers` in binding order. At most 65,535 groups per axis. Throws failure for another number of buffers or size
  /// of push constants than the layout's, and where there is no pipeline yet.
  void dispatch(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
                std::uint32_t groups_x, std::uint32_t groups_y = 1, std::uint32_t groups_z = 1) const;
  /// `arguments`: groups_in() some buffer.
  void dispatch_indirect(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
                         BufferRef arguments) const;

 private:
  void bind(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push) const;

  std::string name_;
  BufferSet set_;
  Handle<VkPipelineLayout> layout_;
  Handle<VkPipeline> pipeline_;
  std::uint32_t push_bytes_ = 0;
};

}  // namespace palpa::gpu
