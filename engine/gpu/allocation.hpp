// The only place that allocates device memory.
#pragma once

#include <cstdint>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// `bytes` of a memory type, counted in `device.memory_allocations`. Throws failure() if the limits of this process
/// leave too little memory for a software device, and an Error with Vulkan's result if the driver has none left.
Handle<VkDeviceMemory> allocate_memory(const Device& device, VkDeviceSize bytes, std::uint32_t memory_type);

}  // namespace palpa::gpu
