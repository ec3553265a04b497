// A compute pipeline whose buffers are pushed at each dispatch: no descriptor sets to allocate or keep alive.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "gpu/buffer.hpp"
#include "gpu/buffer_set.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "gpu/kernel.hpp"
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

class ComputePipeline {
 public:
  /// None yet: false, and not to be dispatched.
  ComputePipeline() = default;
  /// `kernel` is one of namespace palpa::spirv and lives longer; the entry point is main. `push_bytes`: the size of its
  /// push constant block, a multiple of 4, at most 128. `constants`: the values of its specialization constants with
  /// ids 0, 1, ...
  ComputePipeline(const Device& device, const char* name, const Kernel& kernel, std::size_t push_bytes,
                  std::span<const std::uint32_t> constants = {});
  explicit operator bool() const { return static_cast<bool>(pipeline_); }

  /// `buffers`: palpa::spirv::NAME_buffers(...) of the pipeline's kernel, all of them there; those that it reads as
  /// texels have a view of them. At most 65,535 groups per axis. Throws failure for other buffers, for another size of
  /// push constants, and where there is no pipeline yet.
  void dispatch(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push, std::uint32_t groups_x,
                std::uint32_t groups_y = 1, std::uint32_t groups_z = 1) const;
  /// `arguments`: groups_in() some buffer.
  void dispatch_indirect(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push,
                         BufferRef arguments) const;

 private:
  void bind(VkCommandBuffer commands, const KernelBuffers& buffers, const Push& push) const;
  void check(const KernelBuffers& buffers) const;

  std::string name_;
  const Kernel* kernel_ = nullptr;
  BufferSet set_;
  Handle<VkPipelineLayout> layout_;
  Handle<VkPipeline> pipeline_;
  std::uint32_t push_bytes_ = 0;
};

}  // namespace palpa::gpu
