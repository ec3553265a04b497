#include "viewer/render/sheet_painter.hpp"

#include <algorithm>
#include <cstring>

#include "spirv/view_sheet.frag.hpp"
#include "spirv/view_sheet.vert.hpp"

namespace palpa::viewer {

SheetPainter::SheetPainter(const gpu::Device& device, VkFormat colour, VkFormat depth, VkSampleCountFlagBits samples)
    : device_(&device) {
  gpu::GraphicsLayout layout;
  layout.buffers = shader::sheet_buffers;
  layout.push_bytes = sizeof(shader::SheetPush);
  layout.colour = colour;
  layout.depth = depth;
  layout.samples = samples;
  layout.blend = true;
  pipeline_ = {device, "view sheet", spirv::view_sheet_vert, spirv::view_sheet_frag, layout};
}

void SheetPainter::upload(VkCommandBuffer commands, const Sheet& sheet, SheetMemory& memory) const {
  memory.corners_.record(commands, memory.corners_.fill(*device_, sheet.corners, "view sheet"));

  const bool known = memory.glyphs_.data() != nullptr && (!sheet.glyphs || memory.version_ == sheet.glyphs->version);
  if (known) return;
  const std::size_t texels = sheet.glyphs ? sheet.glyphs->coverage.size() : 0;
  memory.glyphs_ = gpu::Upload(*device_, std::max<VkDeviceSize>(texels, 4), "view glyphs");
  if (texels != 0) std::memcpy(memory.glyphs_.data(), sheet.glyphs->coverage.data(), texels);
  memory.glyphs_.record(commands);
  memory.version_ = sheet.glyphs ? sheet.glyphs->version : 0;
}

void SheetPainter::draw(VkCommandBuffer commands, const Sheet& sheet, const SheetMemory& memory,
                        VkExtent2D size) const {
  const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
  const VkViewport viewport{0, 0, width, height, 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  const auto texels = static_cast<float>(sheet.glyphs ? sheet.glyphs->width : 0);
  const shader::SheetPush push{{width, height, texels, 0}};
  for (const SheetRun& run : sheet.runs) {
    const VkRect2D clip{{run.left, run.top}, {run.width, run.height}};
    vkCmdSetScissor(commands, 0, 1, &clip);
    pipeline_.draw(commands, {memory.corners_.ref(), memory.glyphs_.ref()}, push, {.depth_test = false}, run.count,
                   run.first);
  }
}

}  // namespace palpa::viewer
