#include "viewer/render/view_pipelines.hpp"

#include "shaders/viewer/view_scene.h"
#include "spirv/view_disc.frag.hpp"
#include "spirv/view_disc.vert.hpp"
#include "spirv/view_edge.vert.hpp"
#include "spirv/view_image.frag.hpp"
#include "spirv/view_image.vert.hpp"
#include "spirv/view_mesh.frag.hpp"
#include "spirv/view_mesh.vert.hpp"
#include "spirv/view_stroke.frag.hpp"
#include "spirv/view_stroke.vert.hpp"

namespace palpa::viewer {

ViewPipelines make_view_pipelines(const gpu::Device& device, VkFormat colour, VkFormat depth,
                                  VkSampleCountFlagBits samples) {
  ViewPipelines made;
  gpu::GraphicsLayout layout;
  layout.buffers = shader::view_buffers;
  layout.push_bytes = sizeof(shader::ViewPush);
  layout.colour = colour;
  layout.depth = depth;
  layout.samples = samples;
  layout.blend = true;
  made.mesh = {device, "view mesh", spirv::view_mesh_vert, spirv::view_mesh_frag, layout};
  made.mesh_depth = {device, "view mesh depth", spirv::view_mesh_vert, {}, layout};
  made.edge = {device, "view edge", spirv::view_edge_vert, spirv::view_stroke_frag, layout};
  made.stroke = {device, "view stroke", spirv::view_stroke_vert, spirv::view_stroke_frag, layout};
  layout.buffers = shader::view_image_buffers;
  made.image = {device, "view image", spirv::view_image_vert, spirv::view_image_frag, layout};
  layout.buffers = shader::view_buffers;
  layout.blend = samples == VK_SAMPLE_COUNT_1_BIT;
  layout.writes_alpha = layout.blend;
  made.disc = {device, "view disc", spirv::view_disc_vert, spirv::view_disc_frag, layout};
  made.sheets = SheetPainter(device, colour, depth, samples);
  return made;
}

}  // namespace palpa::viewer
