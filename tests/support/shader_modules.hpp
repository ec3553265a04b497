// Shader modules that all pipelines of a device share if GPU-assisted validation instruments them.
#pragma once

#include <volk.h>

#include <cstdint>
#include <map>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::test {

/// The layer writes a number into every module that it instruments: how many it has seen before. A driver's cache then
/// never recognizes a shader, and compiling an instrumented one takes seconds. While this object lives, the device's
/// modules of the same words are one module. palpa's own are created first and in a fixed order, so they have the same
/// numbers in all test executables, and a leg of the matrix compiles each of them once. (A report names the newest
/// pipeline with the module, which may be a different one than the one at fault.)
class ShaderModules {
 public:
  /// One at a time; `device` must outlive it and all pipelines on it.
  explicit ShaderModules(const gpu::Device& device);
  ~ShaderModules();
  ShaderModules(const ShaderModules&) = delete;
  ShaderModules& operator=(const ShaderModules&) = delete;

 private:
  static VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const VkShaderModuleCreateInfo* info,
                                               const VkAllocationCallbacks* callbacks, VkShaderModule* module);
  static VKAPI_ATTR void VKAPI_CALL destroy(VkDevice device, VkShaderModule module,
                                            const VkAllocationCallbacks* callbacks);
  static ShaderModules*& living();

  VkDevice device_;
  PFN_vkCreateShaderModule create_;
  PFN_vkDestroyShaderModule destroy_;
  std::map<std::vector<std::uint32_t>, VkShaderModule> modules_;
};

}  // namespace palpa::test
