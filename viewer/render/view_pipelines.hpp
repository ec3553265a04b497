// The pipelines that draw a picture with a given number of samples for each pixel.
#pragma once

#include "gpu/graphics_pipeline.hpp"
#include "viewer/render/sheet_painter.hpp"

namespace palpa::viewer {

struct ViewPipelines {
  gpu::GraphicsPipeline mesh, mesh_depth, edge, stroke, disc, image;
  SheetPainter sheets;
};

ViewPipelines make_view_pipelines(const gpu::Device& device, VkFormat colour, VkFormat depth,
                                  VkSampleCountFlagBits samples);

}  // namespace palpa::viewer
