// What a device that is software takes of this machine: it computes in this process's memory. Mesa's crashes where an
// allocation of its own fails, so that whether there is enough is asked before.
#pragma once

#include <cstdint>
#include <string>

#include "gpu/device.hpp"

namespace palpa::gpu {

/// A software device computes on processors, whatever driver it is of.
bool is_software(const DeviceDescription& device);

/// Bytes of addresses that a software device and what palpa computes on it take beside what the process has when the
/// driver is loaded, with so many threads of its own.
std::uint64_t software_device_bytes(unsigned threads);

/// Why the process's limits (base/memory_limits.hpp) do not let it use the device, which is software; else nothing.
std::string lacking_room(const DeviceDescription& device);
/// Throws failure() with that.
void require_room_for(const DeviceDescription& device);
/// The same for `bytes` more once it is at work. Cheap where there is no limit.
void require_room_for(const DeviceDescription& device, std::uint64_t bytes);

/// Whether the process's limits leave what drivers take to be loaded. Where they do not, LLVM ends the process.
bool drivers_fit();

/// What would help where no driver, or none that works, was found: `otherwise`, or to raise the limit of memory.
std::string driver_advice(const std::string& otherwise = "install a driver such as mesa-vulkan-drivers");

}  // namespace palpa::gpu
