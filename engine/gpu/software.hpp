// The memory that a software device takes from this machine: it computes in this process's memory. Mesa's driver
// crashes if one of its own allocations fails, so the free memory is checked beforehand.
#pragma once

#include <cstdint>
#include <string>

#include "gpu/device.hpp"

namespace palpa::gpu {

/// Whether the device computes on processors, with any driver.
bool is_software(const DeviceDescription& device);

/// Bytes of address space that a software device and palpa's computations on it need beyond what the process has when
/// the driver is loaded. `threads` is the number of the device's own threads.
std::uint64_t software_device_bytes(unsigned threads);

/// Why the limits of this process (base/system/memory_limits.hpp) prevent it from using the device, which is a software
/// device; empty if they do not.
std::string lacking_room(const DeviceDescription& device);
/// Throws failure() with that reason.
void require_room_for(const DeviceDescription& device);
/// The same for `bytes` more while it is in use. Cheap if there is no limit.
void require_room_for(const DeviceDescription& device, std::uint64_t bytes);

/// Whether the process's limits leave enough memory to load the drivers. If they do not, LLVM ends the process.
bool drivers_fit();

/// Advice if no driver, or no working one, was found: to raise the memory limit, to mend the variable of the
/// environment that chooses drivers for Vulkan's loader, or `otherwise`.
std::string driver_advice(const std::string& otherwise = "install a driver such as mesa-vulkan-drivers");

}  // namespace palpa::gpu
