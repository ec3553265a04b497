#include "gpu/buffer.hpp"

#include <algorithm>
#include <bit>

#include "gpu/allocation.hpp"
#include "gpu/barrier.hpp"
#include "gpu/check.hpp"
#include "gpu/watch.hpp"

namespace palpa::gpu {
namespace {

constexpr VkBufferUsageFlags every_usage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
    VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
    VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

constexpr VkMemoryPropertyFlags host_memory =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

/// Mesa's software device compiles a kernel that reads texels twice: once for buffers whose size in bytes is a power of
/// two, and once for others.
VkDeviceSize never_a_power_of_two(VkDeviceSize bytes) {
  return std::has_single_bit(bytes) ? bytes + 16 : bytes;
}

void copy(VkCommandBuffer commands, BufferRef from, BufferRef to, VkDeviceSize bytes) {
  const VkBufferCopy region{from.offset, to.offset, std::min(bytes, from.size)};
  if (region.size == 0) return;
  if (Watch* const sees = watch) {
    sees->uses(commands, "a copy", from, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, false);
    sees->uses(commands, "a copy", to, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, true);
  }
  vkCmdCopyBuffer(commands, from.buffer, to.buffer, 1, &region);
}

}  // namespace

Buffer::Buffer(const Device& device, VkDeviceSize size, const char* name)
    : Buffer(device, size, name, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) {}

Buffer::Buffer(const Device& device, VkDeviceSize size, const char* name, VkMemoryPropertyFlags required,
               VkMemoryPropertyFlags preferred)
    : size_(std::max<VkDeviceSize>(size, 4)) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = never_a_power_of_two(size_ + texel_room);
  info.usage = every_usage;
  VkBuffer buffer = VK_NULL_HANDLE;
  PALPA_VK(vkCreateBuffer(device.get(), &info, nullptr, &buffer));
  buffer_ = Handle<VkBuffer>(device.get(), buffer, vkDestroyBuffer);
  device.name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer), name);

  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.get(), buffer, &needs);
  memory_ = allocate_memory(device, needs.size, device.memory_type(needs.memoryTypeBits, required, preferred));
  PALPA_VK(vkBindBufferMemory(device.get(), buffer, memory_.get(), 0));
}

std::byte* Buffer::map(const Device& device) const {
  void* mapped = nullptr;
  PALPA_VK(vkMapMemory(device.get(), memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped));
  return static_cast<std::byte*>(mapped);
}

Upload::Upload(const Device& device, VkDeviceSize size, const char* name)
    : host_(device, size, name, host_memory,
            device.unified_memory() ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT : 0),
      mapped_(host_.map(device)) {
  if (!device.unified_memory()) device_ = Buffer(device, size, name);
}

void Upload::record(VkCommandBuffer commands, VkDeviceSize bytes) const {
  if (device_.size() == 0) return;
  copy(commands, host_.ref(), device_.ref(), bytes);
  transfer_to_use(commands);
}

Readback::Readback(const Device& device, VkDeviceSize size, const char* name)
    : host_(device, size, name, host_memory, VK_MEMORY_PROPERTY_HOST_CACHED_BIT), mapped_(host_.map(device)) {
  if (!device.unified_memory()) device_ = Buffer(device, size, name);
}

void Readback::record(VkCommandBuffer commands, VkDeviceSize bytes) const {
  if (device_.size() != 0) {
    writes_to_transfer(commands);
    copy(commands, device_.ref(), host_.ref(), bytes);
  }
  writes_to_host(commands);
  if (Watch* const sees = watch) sees->uses(commands, "the host", host_.ref(), VK_PIPELINE_STAGE_2_HOST_BIT, false);
}

}  // namespace palpa::gpu
