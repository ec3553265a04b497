#include "sensing/skin_pass.hpp"

#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"
#include "shaders/sensing/skin.h"
#include "spirv/skin_count.comp.hpp"
#include "spirv/skin_scatter.comp.hpp"

namespace palpa::sensing {
namespace {

static_assert(sizeof(glm::vec2) == 8, "a ray is one vec2 on the device");
static_assert(tile_pixels % block_pixels == 0, "crops begin and end at whole blocks");

/// The kernels' buffers by name: those of the caller, and the scratch.
struct Buffers : SkinBindings {
  gpu::BufferRef runs = {}, counts = {};
};

constexpr std::uint32_t group_blocks = shader::skin_group * shader::skin_run_blocks;

std::uint32_t crop_groups(const Crop& crop) {
  return gpu::groups_for(crop.blocks(), group_blocks);
}

shader::SkinPush push_of(const Crop& crop, const CameraTable& table, const Box& box) {
  shader::SkinPush push{};
  std::memcpy(&push.pose_x, crop.rows_of_pose, sizeof(crop.rows_of_pose));
  push.box_low = {static_cast<float>(box.low.x), static_cast<float>(box.low.y), static_cast<float>(box.low.z),
                  crop.depth_unit};
  push.box_high = {static_cast<float>(box.high.x), static_cast<float>(box.high.y), static_cast<float>(box.high.z),
                   static_cast<float>(crop.stride)};
  push.pinhole = {table.cx, table.cy, table.per_fx, table.per_fy};
  push.first_block = static_cast<std::uint32_t>(table.first_pixel / block_pixels);
  push.corner = crop.first_column | crop.first_row << 16;
  push.row_blocks = crop.blocks_per_row | (table.pitch / block_pixels) << 16;
  push.blocks = crop.blocks();
  push.depth_range = crop.depth_low | crop.depth_high << 16;
  push.first_index = static_cast<std::uint32_t>(table.first_index);
  push.width = table.width;
  return push;
}

/// The maximum number of groups for any box; each processes skin_group runs.
std::uint32_t skin_groups(const RayTables& tables) {
  std::uint32_t groups = 0;
  for (const CameraTable& table : tables.cameras) {
    groups += gpu::groups_for(std::uint64_t{table.pitch} * table.height / block_pixels, group_blocks);
  }
  return groups;
}

}  // namespace

gpu::Buffer upload_rays(const gpu::Device& device, const RayTables& tables) {
  const std::uint64_t bytes = tables.rays.size() * sizeof(glm::vec2);
  gpu::Buffer rays(device, bytes, "rays");
  if (bytes == 0) return rays;
  const gpu::Upload upload(device, bytes, "rays upload");
  std::memcpy(upload.data(), tables.rays.data(), bytes);
  const gpu::Recorder recorder(device, "rays upload");
  const VkCommandBuffer commands = recorder.begin();
  upload.record(commands);
  const VkBufferCopy region{upload.ref().offset, 0, bytes};
  vkCmdCopyBuffer(commands, upload.ref().buffer, rays.ref().buffer, 1, &region);
  gpu::transfer_to_use(commands);  // later submits read the rays in compute
  gpu::Timeline timeline(device, "rays upload");
  timeline.wait(timeline.submit(recorder.end()));
  return rays;
}

SkinPass::Kernels SkinPass::make(const char* count, const char* scatter, std::uint32_t rays_from_table) const {
  const std::span<const std::uint32_t> constants(&rays_from_table, 1);
  return {{*device_, count, spirv::skin_count_comp, sizeof(shader::SkinPush), constants},
          {*device_, scatter, spirv::skin_scatter_comp, sizeof(shader::SkinPush), constants}};
}

void SkinPass::prepare(const RayTables& tables) {
  if (!scan_) scan_.emplace(*device_);
  for (const CameraTable& camera : tables.cameras) {
    if (camera.pinhole && !pinhole_.count) pinhole_ = make("skin count pinhole", "skin scatter pinhole", 0);
    if (!camera.pinhole && !table_.count) table_ = make("skin count", "skin scatter", 1);
  }
}

std::vector<gpu::ScratchBuffer> SkinPass::scratch(const RayTables& tables) {
  const std::uint64_t groups = skin_groups(tables);
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[runs] = {"skin runs", groups * shader::skin_group * sizeof(shader::SkinRun)};
  list[counts] = {"skin counts", groups * sizeof(std::uint32_t)};
  return list;
}

void SkinPass::record(VkCommandBuffer commands, const SkinBindings& b, const gpu::Scratch& s, const RayTables& tables,
                      const Box& box, std::span<const Crop> crops, const shader::ScanGroups& cut,
                      gpu::Timestamps* times) const {
  if (!scan_) throw failure("the skin pass was not prepared for its cameras");
  const auto kernels = [&](const Crop& crop) -> const Kernels& {
    return tables.cameras[crop.camera].pinhole ? pinhole_ : table_;
  };
  Buffers buffers{b};
  buffers.runs = s[runs];
  buffers.counts = s[counts];
  std::uint32_t groups = 0;
  for (const Crop& crop : crops) {
    shader::SkinPush push = push_of(crop, tables.cameras[crop.camera], box);
    push.first_group = groups;
    kernels(crop).count.dispatch(commands, spirv::skin_count_buffers(buffers), push, crop_groups(crop));
    groups += crop_groups(crop);
  }
  gpu::compute_to_compute(commands);  // counts -> scan
  if (times) times->mark(commands, "skin count");

  const auto room = static_cast<std::uint32_t>(b.points.size / sizeof(SkinPoint));
  scan_->record(commands, {.counts = s[counts], .total = b.total}, {groups, 1, room, cut});
  gpu::compute_to_compute(commands);  // scanned counts, runs -> scatter
  if (times) times->mark(commands, "skin scan");

  groups = 0;
  for (const Crop& crop : crops) {
    shader::SkinPush push = push_of(crop, tables.cameras[crop.camera], box);
    push.first_group = groups;
    kernels(crop).scatter.dispatch(commands, spirv::skin_scatter_buffers(buffers), push, crop_groups(crop));
    groups += crop_groups(crop);
  }
  if (times) times->mark(commands, "skin scatter");
}

}  // namespace palpa::sensing
