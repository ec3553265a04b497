// Draws sheets over a picture.
#pragma once

#include "gpu/graphics_pipeline.hpp"
#include "viewer/picture/sheet.hpp"

namespace palpa::viewer {

/// What one frame in flight draws its sheet with.
class SheetMemory {
 private:
  friend class SheetPainter;
  gpu::Upload corners_, glyphs_;
  std::uint64_t version_ = 0;  ///< of the glyphs
};

class SheetPainter {
 public:
  SheetPainter() = default;
  /// For renderings of these formats and samples.
  SheetPainter(const gpu::Device& device, VkFormat colour, VkFormat depth, VkSampleCountFlagBits samples);

  /// Before the rendering; the last frame that used `memory` has completed. Earlier fetches of vertices and fragments
  /// are ordered before transfers by the caller.
  void upload(VkCommandBuffer commands, const Sheet& sheet, SheetMemory& memory) const;
  /// Within it, over all of a picture of that size; leaves another viewport and scissor behind.
  void draw(VkCommandBuffer commands, const Sheet& sheet, const SheetMemory& memory, VkExtent2D size) const;

 private:
  const gpu::Device* device_ = nullptr;
  gpu::GraphicsPipeline pipeline_;
};

}  // namespace palpa::viewer
