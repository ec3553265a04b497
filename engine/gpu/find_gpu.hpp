// Finds out whether there is a GPU, without loading Vulkan's drivers where the system has none.
#pragma once

#include <optional>
#include <string>

namespace palpa::gpu {

/// The name of the GPU that a Device uses if none is named; none if it would use a driver that computes on the
/// processor, or if there is no driver. Takes tens of milliseconds if the system has a graphics device. Throws as
/// list_devices().
std::optional<std::string> find_gpu();

}  // namespace palpa::gpu
