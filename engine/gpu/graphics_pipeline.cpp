#include "gpu/graphics_pipeline.hpp"

#include <array>

#include "gpu/check.hpp"
#include "gpu/pipeline.hpp"

namespace palpa::gpu {
namespace {

// Far more than the number of draws with one pipeline in two frames.
constexpr std::uint32_t most_in_flight = 4096;

constexpr VkShaderStageFlags stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits kind, VkShaderModule module) {
  VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage = kind;
  info.module = module;
  info.pName = "main";
  return info;
}

}  // namespace

GraphicsPipeline::GraphicsPipeline(const Device& device, const char* name, std::span<const std::uint32_t> vertex,
                                   std::span<const std::uint32_t> fragment, const GraphicsLayout& layout)
    : name_(name), set_(device, name, layout.buffers, stages, most_in_flight), push_bytes_(layout.push_bytes) {
  layout_ = set_.pipeline_layout(device, push_bytes_);
  const auto vertex_module = make_shader_module(device, vertex);
  const auto fragment_module = fragment.empty() ? Handle<VkShaderModule>() : make_shader_module(device, fragment);
  const std::array shader_stages{stage(VK_SHADER_STAGE_VERTEX_BIT, vertex_module.get()),
                                 stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment_module.get())};

  const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  multisample.rasterizationSamples = layout.samples;
  const VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  VkPipelineColorBlendAttachmentState attachment{};
  attachment.blendEnable = layout.blend;
  attachment.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  attachment.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  attachment.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  attachment.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
  if (layout.writes_alpha) attachment.colorWriteMask |= VK_COLOR_COMPONENT_A_BIT;
  if (fragment.empty()) attachment.colorWriteMask = 0;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &attachment;
  constexpr std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT,           VK_DYNAMIC_STATE_SCISSOR,
                                      VK_DYNAMIC_STATE_CULL_MODE,          VK_DYNAMIC_STATE_DEPTH_TEST_ENABLE,
                                      VK_DYNAMIC_STATE_DEPTH_WRITE_ENABLE, VK_DYNAMIC_STATE_DEPTH_COMPARE_OP};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
  dynamic.pDynamicStates = dynamic_states.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &layout.colour;
  rendering.depthAttachmentFormat = layout.depth;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
  info.stageCount = fragment.empty() ? 1 : 2;
  info.pStages = shader_stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  PALPA_VK(vkCreateGraphicsPipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline));
  ++device.pipelines_created;
  pipeline_ = Handle<VkPipeline>(device.get(), pipeline, vkDestroyPipeline);
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name);
}

void GraphicsPipeline::bind(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
                            const DrawState& state) const {
  check_push_bytes(name_, push_bytes_, push);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
  set_.bind(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), {buffers.begin(), buffers.size()});
  if (push_bytes_ != 0) vkCmdPushConstants(commands, layout_.get(), stages, 0, push_bytes_, push.data());
  vkCmdSetCullMode(commands, state.cull);
  vkCmdSetDepthTestEnable(commands, state.depth_test);
  vkCmdSetDepthWriteEnable(commands, state.depth_write);
  vkCmdSetDepthCompareOp(commands, state.compare);
}

void GraphicsPipeline::draw(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
                            const DrawState& state, std::uint32_t vertices, std::uint32_t first) const {
  if (vertices == 0) return;
  bind(commands, buffers, push, state);
  vkCmdDraw(commands, vertices, 1, first, 0);
}

void GraphicsPipeline::draw(VkCommandBuffer commands, std::initializer_list<BufferRef> buffers, const Push& push,
                            const DrawState& state, const Run& run) const {
  if (run.count == 0) return;
  bind(commands, buffers, push, state);
  vkCmdBindIndexBuffer(commands, run.indices.buffer, run.indices.offset, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(commands, run.count, 1, run.first, 0, 0);
}

}  // namespace palpa::gpu
