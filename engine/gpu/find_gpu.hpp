// Finds out whether there is a GPU, without loading Vulkan's drivers where the system has none.
#pragma once

#include <optional>
#include <string>

namespace palpa::gpu {

/// The name of the first usable device that is not a driver that computes on the processor; none if there is none, or
/// if the drivers cannot be loaded. Takes tens of milliseconds if the system has a graphics device, otherwise none.
std::optional<std::string> find_gpu();

}  // namespace palpa::gpu
