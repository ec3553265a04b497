// Draws sheets over a picture.
#pragma once

#include "gpu/graphics_pipeline.hpp"
#include "viewer/picture/sheet.hpp"

namespace palpa::viewer {

/// The memory with which one frame in flight draws its sheet.
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

  /// Call before the rendering, when the last frame that used `memory` has completed. The caller orders earlier fetches
  /// of vertices and fragments before transfers.
  void upload(VkCommandBuffer commands, const Sheet& sheet, SheetMemory& memory) const;
  /// Call within the rendering. Draws over a whole picture of that size, and changes viewport and scissor.
  void draw(VkCommandBuffer commands, const Sheet& sheet, const SheetMemory& memory, VkExtent2D size) const;

 private:
  const gpu::Device* device_ = nullptr;
  gpu::GraphicsPipeline pipeline_;
};

}  // namespace palpa::viewer
