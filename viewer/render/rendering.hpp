// Draws into one image, at once or piece by piece. Other work on the same processor can go first between the pieces.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>

#include "gpu/graphics_pipeline.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {

/// Ends the commands of a piece and submits them to the device. Returns a begun command buffer for the next piece,
/// which the device gets after that. Empty: everything is one piece.
using NextStep = std::function<VkCommandBuffer()>;

/// One vkCmdBeginRendering, or one for each piece. What is drawn has the same bytes either way.
class Rendering {
 public:
  /// The images that are drawn to, in the layouts for that. Their old contents are lost. Afterwards, only `target` is
  /// defined.
  struct Images {
    VkExtent2D extent{};
    VkImageView target = VK_NULL_HANDLE;
    VkImageView samples = VK_NULL_HANDLE;  ///< if there are several for each pixel of the target
    VkImageView depth = VK_NULL_HANDLE;
  };
  /// A piece consists of `draws` draws. `next` must outlive this object.
  Rendering(VkCommandBuffer commands, const Images& images, const Colour& background, const NextStep& next,
            std::size_t draws = 1);

  /// The commands of the piece under way.
  VkCommandBuffer commands() const { return commands_; }
  /// Sets viewport and scissor for what is drawn from now on.
  void set_area(const VkRect2D& area);

  /// As GraphicsPipeline::draw.
  using Buffers = std::initializer_list<gpu::BufferRef>;
  void draw(const gpu::GraphicsPipeline& pipeline, Buffers buffers, const gpu::Push& push, const gpu::DrawState& state,
            std::uint32_t vertices, std::uint32_t first = 0);
  void draw(const gpu::GraphicsPipeline& pipeline, Buffers buffers, const gpu::Push& push, const gpu::DrawState& state,
            const gpu::GraphicsPipeline::Run& run);

  /// Call once, after everything else. Returns the commands of the last piece, outside of any rendering.
  VkCommandBuffer end();

 private:
  void begin();
  void drew();
  void end_piece();
  void resolve_at_end();

  VkCommandBuffer commands_;
  Images images_;
  const NextStep* next_;
  VkRenderingAttachmentInfo colour_{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRenderingAttachmentInfo depth_{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  VkRect2D area_{};
  std::size_t draws_, drawn_ = 0;  ///< per piece, and in the piece under way
};

}  // namespace palpa::viewer
