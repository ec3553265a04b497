#include "support/shader_modules.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace palpa::test {
namespace {

/// All compiled shaders, in the order of their files' names.
std::vector<std::vector<std::uint32_t>> palpas_shaders() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(PALPA_SPIRV_DIR)) {
    if (entry.path().extension() == ".spv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::vector<std::uint32_t>> shaders;
  for (const auto& file : files) {
    std::vector<std::uint32_t> words(std::filesystem::file_size(file) / sizeof(std::uint32_t));
    std::ifstream(file, std::ios::binary)
        .read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(words.size() * sizeof(words[0])));
    shaders.push_back(std::move(words));
  }
  return shaders;
}

}  // namespace

ShaderModules*& ShaderModules::living() {
  static ShaderModules* modules = nullptr;  // Vulkan passes no context to replacements of its functions
  return modules;
}

ShaderModules::ShaderModules(const gpu::Device& device)
    : device_(device.get()), create_(vkCreateShaderModule), destroy_(vkDestroyShaderModule) {
  living() = this;
  vkCreateShaderModule = create;
  vkDestroyShaderModule = destroy;
  for (const auto& words : palpas_shaders()) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size() * sizeof(words[0]);
    info.pCode = words.data();
    VkShaderModule module = VK_NULL_HANDLE;
    create(device_, &info, nullptr, &module);
  }
}

ShaderModules::~ShaderModules() {
  vkCreateShaderModule = create_;
  vkDestroyShaderModule = destroy_;
  living() = nullptr;
  for (const auto& [words, module] : modules_)
    destroy_(device_, module, nullptr);
}

VkResult ShaderModules::create(VkDevice device, const VkShaderModuleCreateInfo* info,
                               const VkAllocationCallbacks* callbacks, VkShaderModule* module) {
  ShaderModules& all = *living();
  if (device != all.device_) return all.create_(device, info, callbacks, module);
  const std::vector<std::uint32_t> words(info->pCode, info->pCode + info->codeSize / sizeof(std::uint32_t));
  const auto known = all.modules_.find(words);
  if (known != all.modules_.end()) {
    *module = known->second;
    return VK_SUCCESS;
  }
  const VkResult result = all.create_(device, info, callbacks, module);
  if (result == VK_SUCCESS) all.modules_.emplace(words, *module);
  return result;
}

void ShaderModules::destroy(VkDevice device, VkShaderModule module, const VkAllocationCallbacks* callbacks) {
  ShaderModules& all = *living();
  if (device != all.device_) all.destroy_(device, module, callbacks);
}

}  // namespace palpa::test
