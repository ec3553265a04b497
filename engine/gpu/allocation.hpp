// Device memory: the one place where any of it is allocated.
#pragma once

#include <cstdint>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// `bytes` of a memory type, counted in `device.memory_allocations`. Throws failure() where the limits of this process
/// do not let a software device have them, and an Error with Vulkan's result where the driver has none.
Handle<VkDeviceMemory> allocate_memory(const Device& device, VkDeviceSize bytes, std::uint32_t memory_type);

}  // namespace palpa::gpu
