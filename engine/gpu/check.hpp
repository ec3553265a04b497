// Every Vulkan call that returns a VkResult goes through PALPA_VK. A failure becomes an Error with the call's text, its
// file and line, and the result's name.
#pragma once

#include <volk.h>

namespace palpa::gpu {

/// The result's name, "VK_ERROR_DEVICE_LOST" and so on.
const char* result_name(VkResult result);

/// Throws Error (Exit::failed) unless `result` is a success code.
void check_result(VkResult result, const char* call, const char* file, int line);

}  // namespace palpa::gpu

#define PALPA_VK(call) ::palpa::gpu::check_result((call), #call, __FILE__, __LINE__)
