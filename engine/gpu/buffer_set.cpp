#include "gpu/buffer_set.hpp"

#include <fmt/core.h>

#include <array>

#include "base/error.hpp"
#include "gpu/check.hpp"
#include "gpu/kernel.hpp"

namespace palpa::gpu {
namespace {
constexpr std::uint32_t most_buffers = most_kernel_buffers;
}  // namespace

BufferSet::BufferSet(const Device& device, const char* name, std::uint32_t count, VkShaderStageFlags stages,
                     std::uint32_t most_uses, std::uint32_t texels)
    : name_(name), stages_(stages), count_(count), texels_(texels), device_(device.get()) {
  if (count > most_buffers) {
    throw failure(fmt::format("pipeline '{}' binds {} buffers: at most {}", name, count, most_buffers));
  }
  const bool pushed = device.validation() != Validation::gpu_assisted;
  std::array<VkDescriptorSetLayoutBinding, most_buffers> bindings{};
  for (std::uint32_t i = 0; i < count; ++i) {
    bindings[i] = {i, type(i), 1, stages, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.flags = pushed ? VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR : 0;
  info.bindingCount = count;
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  PALPA_VK(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout));
  layout_ = Handle<VkDescriptorSetLayout>(device.get(), layout, vkDestroyDescriptorSetLayout);
  if (pushed || count == 0) return;

  // The number of bindings for each type, which is more than needed.
  const std::array<VkDescriptorPoolSize, 2> sizes{{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, most_uses * count},
                                                   {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, most_uses * count}}};
  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.maxSets = most_uses;
  pool_info.poolSizeCount = texels == 0 ? 1 : 2;
  pool_info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  PALPA_VK(vkCreateDescriptorPool(device.get(), &pool_info, nullptr, &pool));
  ring_pool_ = Handle<VkDescriptorPool>(device.get(), pool, vkDestroyDescriptorPool);
  const std::vector<VkDescriptorSetLayout> layouts(most_uses, layout);
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = most_uses;
  allocate.pSetLayouts = layouts.data();
  ring_.resize(most_uses);
  PALPA_VK(vkAllocateDescriptorSets(device.get(), &allocate, ring_.data()));
}

Handle<VkPipelineLayout> BufferSet::pipeline_layout(const Device& device, std::uint32_t push_bytes) const {
  const VkDescriptorSetLayout set = layout_.get();
  const VkPushConstantRange range{stages_, 0, push_bytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &set;
  info.pushConstantRangeCount = push_bytes ? 1 : 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  PALPA_VK(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout));
  return {device.get(), layout, vkDestroyPipelineLayout};
}

VkDescriptorType BufferSet::type(std::uint32_t binding) const {
  return (texels_ >> binding & 1U) != 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

void BufferSet::bind(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipelineLayout layout,
                     std::span<const BufferRef> buffers) const {
  if (buffers.size() != count_) {
    throw failure(
        fmt::format("pipeline '{}' was given {} buffers: its shader binds {}", name_, buffers.size(), count_));
  }
  if (count_ == 0) return;
  const VkDescriptorSet set = ring_.empty() ? VK_NULL_HANDLE : ring_[ring_next_++ % ring_.size()];
  std::array<VkDescriptorBufferInfo, most_buffers> infos{};
  std::array<VkWriteDescriptorSet, most_buffers> writes{};
  std::uint32_t i = 0;
  for (const BufferRef& ref : buffers) {
    infos[i] = {ref.buffer, ref.offset, ref.size};
    writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[i].dstSet = set;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = type(i);
    writes[i].pBufferInfo = &infos[i];
    writes[i].pTexelBufferView = &ref.texels;
    const bool texels = type(i) == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    if (texels ? ref.texels == VK_NULL_HANDLE : ref.buffer == VK_NULL_HANDLE) {
      throw failure(fmt::format("pipeline '{}' was given no {} at binding {}", name_, texels ? "texels" : "buffer", i));
    }
    ++i;
  }
  if (set == VK_NULL_HANDLE) {
    vkCmdPushDescriptorSetKHR(commands, point, layout, 0, i, writes.data());
  } else {
    vkUpdateDescriptorSets(device_, i, writes.data(), 0, nullptr);
    vkCmdBindDescriptorSets(commands, point, layout, 0, 1, &set, 0, nullptr);
  }
}

}  // namespace palpa::gpu
