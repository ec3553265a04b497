// A compute pipeline whose buffers are pushed at each dispatch, without descriptor sets to allocate or keep alive.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "gpu/buffer.hpp"
#include "gpu/buffer_set.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "gpu/kernel.hpp"
#include "gpu/push.hpp"

namespace palpa::gpu {

/// Number of groups needed so that groups * group_size >= threads.
constexpr std::uint32_t groups_for(std::uint64_t threads, std::uint32_t group_size) {
  return static_cast<std::uint32_t>((threads + group_size - 1) / group_size);
}

/// The group counts of an indirect dispatch: a VkDispatchIndirectCommand at byte `at` of `buffer`.
inline BufferRef groups_in(const BufferRef& buffer, VkDeviceSize at = 0) {
  return {buffer.buffer, buffer.offset + at, sizeof(VkDispatchIndirectCommand)};
}

/// A compiled shader's SPIR-V as Vulkan takes it.
Handle<VkShaderModule> make_shader_module(const Device& device, std::span<const std::uint32_t> words);

class ComputePipeline {
 public:
  /// No pipeline yet: converts to false and must not be dispatched.
  ComputePipeline() = default;
  /// `kernel` is one of namespace palpa::spirv and must outlive the pipeline; the entry point is main. `push_bytes` is
  /// the size of its push constant block, a multiple of 4, at most 128. `constants` are the values of its
  /// specialization constants with ids 0, 1, ... On a device that keeps its pipelines (DeviceOptions::keep_pipelines),
  /// one with the same kernel, size and constants is made once and shared.
  ComputePipeline(const Device& device, const char* name, const Kernel& kernel, std::size_t push_bytes,
                  std::span<const std::uint32_t> constants = {});
  explicit operator bool() const { return made_ != nullptr; }

  /// `buffers`: palpa::spirv::NAME_buffers(...) of the pipeline's kernel, not null. Those read as texels must
  /// have a texel view. At most 65,535 groups per axis. Throws failure for other buffers, for another size of push
  /// constants, and if there is no pipeline yet.
  void dispatch(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push, std::uint32_t groups_x,
                std::uint32_t groups_y = 1, std::uint32_t groups_z = 1) const;
  /// `arguments`: groups_in() of a buffer.
  void dispatch_indirect(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push,
                         BufferRef arguments) const;

 private:
  /// What the device made; shared by equal pipelines of a device that keeps them.
  struct Made {
    BufferSet set;
    Handle<VkPipelineLayout> layout;
    Handle<VkPipeline> pipeline;
  };

  std::shared_ptr<const Made> make(const Device& device, const char* name,
                                   std::span<const std::uint32_t> constants) const;
  void bind(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push) const;
  void check(const KernelBuffers& buffers) const;

  std::string name_;
  const Kernel* kernel_ = nullptr;
  std::shared_ptr<const Made> made_;
  std::uint32_t push_bytes_ = 0;
};

}  // namespace palpa::gpu
