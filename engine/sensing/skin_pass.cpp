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
  gpu::BufferRef runs = {}, counts = {}, offsets = {};
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

namespace {

/// `name`: of the upload, for the driver's messages.
gpu::Buffer upload(const gpu::Device& device, std::span<const std::byte> bytes, const char* name) {
  gpu::Buffer buffer(device, bytes.size(), name);
  if (bytes.empty()) return buffer;
  const gpu::Upload from(device, bytes.size(), name);
  std::memcpy(from.data(), bytes.data(), bytes.size());
  const gpu::Recorder recorder(device, name);
  const VkCommandBuffer commands = recorder.begin();
  from.record(commands);
  const VkBufferCopy region{from.ref().offset, 0, bytes.size()};
  vkCmdCopyBuffer(commands, from.ref().buffer, buffer.ref().buffer, 1, &region);
  gpu::transfer_to_use(commands);  // later submits read them in compute
  gpu::Timeline timeline(device, name);
  timeline.wait(timeline.submit(recorder.end()));
  return buffer;
}

}  // namespace

gpu::Buffer upload_rays(const gpu::Device& device, const RayTables& tables) {
  return upload(device, std::as_bytes(std::span(tables.rays)), "rays");
}

gpu::Buffer upload_limits(const gpu::Device& device, const RayTables& tables) {
  // At least one block, so that there is something to bind.
  static constexpr std::uint16_t nothing[block_pixels] = {};
  if (tables.limits.empty()) return upload(device, std::as_bytes(std::span(nothing)), "background limits");
  return upload(device, std::as_bytes(std::span(tables.limits)), "background limits");
}

void SkinPass::make(Kernels& kernels, std::uint32_t rays_from_table, std::uint32_t drops) const {
  const std::uint32_t constants[] = {rays_from_table, drops};
  static constexpr const char* names[] = {"skin count", "skin count in surroundings", "skin count before a background",
                                          "skin count in surroundings before a background"};
  if (!kernels.count[drops]) {
    kernels.count[drops] = {*device_, names[drops], spirv::skin_count_comp, sizeof(shader::SkinPush), constants};
  }
  if (!kernels.scatter) {
    kernels.scatter = {*device_, "skin scatter", spirv::skin_scatter_comp, sizeof(shader::SkinPush),
                       std::span(constants).first(1)};
  }
}

void SkinPass::prepare(const RayTables& tables, bool surrounded) {
  if (!scan_) scan_.emplace(*device_);
  for (const CameraTable& camera : tables.cameras) {
    Kernels& kernels = camera.pinhole ? pinhole_ : table_;
    const std::uint32_t drops = camera.background ? shader::skin_drops_background : 0;
    make(kernels, camera.pinhole ? 0 : 1, drops);
    if (surrounded) make(kernels, camera.pinhole ? 0 : 1, drops | shader::skin_drops_volumes);
  }
}

std::vector<gpu::ScratchBuffer> SkinPass::scratch(const RayTables& tables) {
  const std::uint64_t groups = skin_groups(tables);
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[runs] = {"skin runs", groups * shader::skin_group * sizeof(shader::SkinRun)};
  list[counts] = {"skin counts", groups * sizeof(std::uint32_t)};
  list[offsets] = {"skin offsets", list[counts].bytes};
  return list;
}

void SkinPass::record(VkCommandBuffer commands, const SkinBindings& b, const gpu::Scratch& s, const RayTables& tables,
                      const Box& box, std::span<const Crop> crops, const shader::ScanGroups& cut,
                      gpu::Timestamps* times, std::size_t volumes) const {
  if (!scan_) throw failure("the skin pass was not prepared for its cameras");
  const auto kernels = [&](const Crop& crop) -> const Kernels& {
    return tables.cameras[crop.camera].pinhole ? pinhole_ : table_;
  };
  const auto counting = [&](const Crop& crop) -> const gpu::ComputePipeline& {
    return kernels(crop).count[(volumes > 0 ? shader::skin_drops_volumes : 0) |
                               (tables.cameras[crop.camera].background ? shader::skin_drops_background : 0)];
  };
  Buffers buffers{b};
  if (volumes > 0) buffers.volumes.size = volumes * sizeof(shader::SkinVolume);  // its length in the kernel
  buffers.runs = s[runs];
  buffers.counts = s[counts];
  buffers.offsets = s[offsets];
  gpu::writes_to_transfer(commands);  // an earlier submit may have counted here
  vkCmdFillBuffer(commands, b.dropped.buffer, b.dropped.offset, b.dropped.size, 0);
  gpu::transfer_to_use(commands);
  std::uint32_t groups = 0;
  for (const Crop& crop : crops) {
    shader::SkinPush push = push_of(crop, tables.cameras[crop.camera], box);
    push.first_group = groups;
    counting(crop).dispatch(commands, spirv::skin_count_buffers(buffers), push, crop_groups(crop));
    groups += crop_groups(crop);
  }
  gpu::compute_to_compute(commands);  // counts -> scan
  if (times) times->mark(commands, "skin count");

  const auto room = static_cast<std::uint32_t>(b.points.size / sizeof(SkinPoint));
  scan_->record(commands, {.counts = s[counts], .offsets = s[offsets], .total = b.total}, {groups, room, cut});
  gpu::compute_to_compute(commands);  // offsets, runs -> scatter
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
