#include "gpu/pipeline.hpp"

#include <array>
#include <cassert>
#include <vector>

#include "gpu/check.hpp"

namespace palpa::gpu {
namespace {
constexpr std::uint32_t most_buffers = 16;
constexpr std::uint32_t ring_length = 512;
}  // namespace

ComputePipeline::ComputePipeline(const Device& device, const char* name, std::span<const std::uint32_t> spirv,
                                 const PipelineLayout& layout)
    : buffers_(layout.buffers), push_bytes_(layout.push_bytes), device_(device.get()) {
  assert(layout.buffers <= most_buffers && layout.push_bytes <= 128);
  std::array<VkDescriptorSetLayoutBinding, most_buffers> bindings{};
  for (std::uint32_t i = 0; i < buffers_; ++i) {
    bindings[i] = {i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  const bool pushed = device.validation() != Validation::gpu_assisted;
  set.flags = pushed ? VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR : 0;
  set.bindingCount = buffers_;
  set.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  PALPA_VK(vkCreateDescriptorSetLayout(device.get(), &set, nullptr, &set_layout));
  set_layout_ = Handle<VkDescriptorSetLayout>(device.get(), set_layout, vkDestroyDescriptorSetLayout);

  if (!pushed) make_descriptor_ring(device);

  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = push_bytes_ ? 1 : 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout pipeline_layout = VK_NULL_HANDLE;
  PALPA_VK(vkCreatePipelineLayout(device.get(), &info, nullptr, &pipeline_layout));
  layout_ = Handle<VkPipelineLayout>(device.get(), pipeline_layout, vkDestroyPipelineLayout);

  VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  module_info.codeSize = spirv.size_bytes();
  module_info.pCode = spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  PALPA_VK(vkCreateShaderModule(device.get(), &module_info, nullptr, &shader));
  const Handle<VkShaderModule> shader_owner(device.get(), shader, vkDestroyShaderModule);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < layout.constants.size(); ++i) {
    entries.push_back({i, static_cast<std::uint32_t>(i * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
  }
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            layout.constants.size_bytes(), layout.constants.data()};
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = shader;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = entries.empty() ? nullptr : &specialization;
  create.layout = pipeline_layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  PALPA_VK(vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &create, nullptr, &pipeline));
  ++device.pipelines_created;
  pipeline_ = Handle<VkPipeline>(device.get(), pipeline, vkDestroyPipeline);
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name);
}

void ComputePipeline::make_descriptor_ring(const Device& device) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, ring_length * buffers_};
  VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  info.maxSets = ring_length;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  PALPA_VK(vkCreateDescriptorPool(device.get(), &info, nullptr, &pool));
  ring_pool_ = Handle<VkDescriptorPool>(device.get(), pool, vkDestroyDescriptorPool);
  const std::vector<VkDescriptorSetLayout> layouts(ring_length, set_layout_.get());
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = ring_length;
  allocate.pSetLayouts = layouts.data();
  ring_.resize(ring_length);
  PALPA_VK(vkAllocateDescriptorSets(device.get(), &allocate, ring_.data()));
}

void ComputePipeline::bind(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const void* push) const {
  assert(buffers.size() == buffers_);
  std::array<VkDescriptorBufferInfo, most_buffers> infos{};
  std::array<VkWriteDescriptorSet, most_buffers> writes{};
  std::uint32_t i = 0;
  for (const BufferRef& ref : buffers) {
    infos[i] = {ref.buffer, ref.offset, ref.size};
    writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[i].pBufferInfo = &infos[i];
    ++i;
  }
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
  if (ring_.empty()) {
    vkCmdPushDescriptorSetKHR(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, i, writes.data());
  } else {
    const VkDescriptorSet descriptors = ring_[ring_next_++ % ring_.size()];
    for (std::uint32_t w = 0; w < i; ++w)
      writes[w].dstSet = descriptors;
    vkUpdateDescriptorSets(device_, i, writes.data(), 0, nullptr);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &descriptors, 0, nullptr);
  }
  if (push_bytes_) {
    vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_, push);
  }
}

void ComputePipeline::dispatch(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const void* push,
                               std::uint32_t groups_x, std::uint32_t groups_y, std::uint32_t groups_z) const {
  if (groups_x == 0 || groups_y == 0 || groups_z == 0) return;
  bind(commands, buffers, push);
  vkCmdDispatch(commands, groups_x, groups_y, groups_z);
}

void ComputePipeline::dispatch_indirect(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers,
                                        const void* push, BufferRef arguments) const {
  bind(commands, buffers, push);
  vkCmdDispatchIndirect(commands, arguments.buffer, arguments.offset);
}

}  // namespace palpa::gpu
