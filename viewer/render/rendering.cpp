#include "viewer/render/rendering.hpp"

#include "gpu/barrier.hpp"

namespace palpa::viewer {
namespace {

/// Each piece is drawn over the pieces before it.
void after_last_piece(VkCommandBuffer commands) {
  constexpr VkPipelineStageFlags2 draws = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT |
                                          VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags2 writes =
      VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  gpu::barrier(commands, draws, writes, draws,
               writes | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT);
}

}  // namespace

Rendering::Rendering(VkCommandBuffer commands, const Images& images, const Colour& background, const NextStep& next,
                     std::size_t draws)
    : commands_(commands), images_(images), next_(&next), draws_(draws) {
  const bool several = images.samples != VK_NULL_HANDLE;
  colour_.imageView = several ? images.samples : images.target;
  colour_.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  colour_.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  colour_.storeOp = several && !next ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE;
  colour_.clearValue.color = {{background.r, background.g, background.b, 1.0f}};
  depth_.imageView = images.depth;
  depth_.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  depth_.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth_.storeOp = next ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth_.clearValue.depthStencil = {0.0f, 0};
  if (!next) resolve_at_end();
  begin();
}

void Rendering::resolve_at_end() {
  if (images_.samples == VK_NULL_HANDLE) return;
  colour_.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
  colour_.resolveImageView = images_.target;
  colour_.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
}

void Rendering::begin() {
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = images_.extent;
  info.layerCount = 1;
  info.colorAttachmentCount = 1;
  info.pColorAttachments = &colour_;
  info.pDepthAttachment = &depth_;
  vkCmdBeginRendering(commands_, &info);
}

void Rendering::drew() {
  if (!*next_ || ++drawn_ < draws_) return;
  end_piece();
  set_area(area_);
}

void Rendering::end_piece() {
  drawn_ = 0;
  vkCmdEndRendering(commands_);
  commands_ = (*next_)();
  after_last_piece(commands_);
  colour_.loadOp = depth_.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  begin();
}

void Rendering::set_area(const VkRect2D& area) {
  area_ = area;
  const VkViewport viewport{static_cast<float>(area.offset.x),
                            static_cast<float>(area.offset.y),
                            static_cast<float>(area.extent.width),
                            static_cast<float>(area.extent.height),
                            0,
                            1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  vkCmdSetScissor(commands_, 0, 1, &area);
}

void Rendering::draw(const gpu::GraphicsPipeline& pipeline, Buffers buffers, const gpu::Push& push,
                     const gpu::DrawState& state, std::uint32_t vertices, std::uint32_t first) {
  pipeline.draw(commands_, buffers, push, state, vertices, first);
  if (vertices > 0) drew();
}

void Rendering::draw(const gpu::GraphicsPipeline& pipeline, Buffers buffers, const gpu::Push& push,
                     const gpu::DrawState& state, const gpu::GraphicsPipeline::Run& run) {
  pipeline.draw(commands_, buffers, push, state, run);
  if (run.count > 0) drew();
}

// With several samples, the last piece only resolves them.
VkCommandBuffer Rendering::end() {
  if (*next_ && images_.samples != VK_NULL_HANDLE) {
    resolve_at_end();
    end_piece();
  }
  vkCmdEndRendering(commands_);
  return commands_;
}

}  // namespace palpa::viewer
