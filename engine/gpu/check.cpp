#include "gpu/check.hpp"

#include <fmt/core.h>

#include <cstring>

#include "base/error.hpp"

namespace palpa::gpu {

const char* result_name(VkResult result) {
  switch (result) {
#define PALPA_NAME(name) \
  case name:             \
    return #name
    PALPA_NAME(VK_SUCCESS);
    PALPA_NAME(VK_NOT_READY);
    PALPA_NAME(VK_TIMEOUT);
    PALPA_NAME(VK_INCOMPLETE);
    PALPA_NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
    PALPA_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
    PALPA_NAME(VK_ERROR_INITIALIZATION_FAILED);
    PALPA_NAME(VK_ERROR_DEVICE_LOST);
    PALPA_NAME(VK_ERROR_MEMORY_MAP_FAILED);
    PALPA_NAME(VK_ERROR_LAYER_NOT_PRESENT);
    PALPA_NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
    PALPA_NAME(VK_ERROR_FEATURE_NOT_PRESENT);
    PALPA_NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
    PALPA_NAME(VK_ERROR_TOO_MANY_OBJECTS);
    PALPA_NAME(VK_ERROR_SURFACE_LOST_KHR);
    PALPA_NAME(VK_ERROR_OUT_OF_DATE_KHR);
    PALPA_NAME(VK_SUBOPTIMAL_KHR);
#undef PALPA_NAME
    default:
      return "an unnamed VkResult";
  }
}

void check_result(VkResult result, const char* call, const char* file, int line) {
  if (result >= VK_SUCCESS) return;
  const char* slash = std::strrchr(file, '/');
  const char* paren = std::strchr(call, '(');
  const std::string function(call, paren ? static_cast<std::size_t>(paren - call) : std::strlen(call));
  const char* advice = result == VK_ERROR_DEVICE_LOST ? "; the GPU was lost, start again" : "";
  throw failure(fmt::format("Vulkan: {} returned {} ({}:{}){}", function, result_name(result), slash ? slash + 1 : file,
                            line, advice));
}

}  // namespace palpa::gpu
