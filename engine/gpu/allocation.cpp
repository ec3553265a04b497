#include "gpu/allocation.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>

#include "base/error.hpp"
#include "gpu/check.hpp"
#include "gpu/software.hpp"

namespace palpa::gpu {
namespace {

/// Whether a byte can be read. The kernel copies it into a pipe, and reports a missing page instead of sending SIGBUS.
bool readable(const std::byte* at) {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) return true;  // unknown
  const bool missing = write(pipe_ends[1], at, 1) < 0 && errno == EFAULT;
  close(pipe_ends[0]);
  close(pipe_ends[1]);
  return !missing;
}

/// From version 24 on, Mesa's software device keeps its memory in a file without a name. It does not notice if a limit
/// of file sizes keeps that file from growing, and the first access then ends the process with SIGBUS.
void require_backed(const Device& device, VkDeviceMemory memory, VkDeviceSize bytes) {
  rlimit limit{};
  if (!is_software(device.description()) || getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return;
  void* mapped = nullptr;
  PALPA_VK(vkMapMemory(device.get(), memory, 0, VK_WHOLE_SIZE, 0, &mapped));
  const bool backed = readable(static_cast<const std::byte*>(mapped) + bytes - 1);
  vkUnmapMemory(device.get(), memory);
  if (backed) return;
  throw failure(fmt::format(
      "{} keeps its memory in a file that may not grow beyond {} MB (ulimit -f): raise that limit, or remove it",
      device.description().name, static_cast<double>(limit.rlim_cur) / 1e6));
}

}  // namespace

Handle<VkDeviceMemory> allocate_memory(const Device& device, VkDeviceSize bytes, std::uint32_t memory_type) {
  require_room_for(device.description(), bytes);
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = bytes;
  info.memoryTypeIndex = memory_type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  PALPA_VK(vkAllocateMemory(device.get(), &info, nullptr, &memory));
  Handle<VkDeviceMemory> owned(device.get(), memory, vkFreeMemory);
  ++device.memory_allocations;
  require_backed(device, memory, bytes);
  return owned;
}

}  // namespace palpa::gpu
