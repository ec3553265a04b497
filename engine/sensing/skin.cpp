#include "sensing/skin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/commands.hpp"
#include "shaders/skin.h"
#include "spirv/skin_count.comp.hpp"
#include "spirv/skin_scatter.comp.hpp"

namespace palpa::sensing {
namespace {

static_assert(sizeof(SkinPoint) == 16, "a skin point is one vec4 on the device");
static_assert(sizeof(glm::vec2) == 8, "a ray is one vec2 on the device");
static_assert(skin_group_runs == shader::skin_group);
static_assert(tile_pixels % block_pixels == 0, "views begin and end at whole blocks");

constexpr std::uint32_t group_blocks = shader::skin_group * shader::skin_run_blocks;

std::uint32_t view_groups(const View& view) {
  return gpu::groups_for(view.blocks(), group_blocks);
}

shader::SkinPush push_of(const View& view, const CameraTable& table, const Box& box) {
  shader::SkinPush push{};
  std::memcpy(&push.pose_x, view.rows_of_pose, sizeof(view.rows_of_pose));
  push.box_low = {static_cast<float>(box.low.x), static_cast<float>(box.low.y), static_cast<float>(box.low.z),
                  view.depth_unit};
  push.box_high = {static_cast<float>(box.high.x), static_cast<float>(box.high.y), static_cast<float>(box.high.z), 0};
  push.pinhole = {table.cx, table.cy, table.per_fx, table.per_fy};
  push.first_block = static_cast<std::uint32_t>(table.first_pixel / block_pixels);
  push.corner = view.first_column | view.first_row << 16;
  push.row_blocks = view.blocks_per_row | (table.pitch / block_pixels) << 16;
  push.blocks = view.blocks();
  push.depth_range = view.depth_low | view.depth_high << 16;
  push.first_index = static_cast<std::uint32_t>(table.first_index);
  push.width = table.width;
  return push;
}

void find_in_view(const View& view, const CameraTable& table, std::span<const glm::vec2> rays,
                  std::span<const std::uint16_t> depth, const glm::vec3& low, const glm::vec3& high,
                  std::vector<SkinPoint>& out) {
  const auto& pose = view.rows_of_pose;
  const std::uint32_t span = view.depth_high - view.depth_low;
  const std::uint32_t end_column = std::min(view.first_column + view.blocks_per_row * block_pixels, table.width);
  for (std::uint32_t v = view.first_row; v < view.first_row + view.rows; ++v) {
    const std::uint16_t* row = depth.data() + std::size_t{v} * table.width;
    const glm::vec2* ray_row = rays.data() + table.first_pixel + std::size_t{v} * table.pitch;
    for (std::uint32_t u = view.first_column; u < end_column; ++u) {
      if (row[u] - view.depth_low > span) continue;
      const float z = static_cast<float>(row[u]) * view.depth_unit;
      const float x = ray_row[u].x * z, y = ray_row[u].y * z;
      glm::vec3 world;
      for (int i = 0; i < 3; ++i)
        world[i] = ((pose[i][0] * x + pose[i][1] * y) + pose[i][2] * z) + pose[i][3];
      if (world.x < low.x || world.y < low.y || world.z < low.z || world.x > high.x || world.y > high.y ||
          world.z > high.z) {
        continue;
      }
      out.push_back({world, static_cast<std::uint32_t>(table.first_index) + v * table.width + u});
    }
  }
}

}  // namespace

void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const View> views,
               std::vector<SkinPoint>& out) {
  out.clear();
  for (std::size_t i = 0; i < tables.cameras.size(); ++i) {
    const CameraTable& table = tables.cameras[i];
    if (frames.size() != tables.cameras.size() || frames[i].depth.size() != std::size_t{table.width} * table.height) {
      throw bad_usage(fmt::format("the depth frames do not fit the {} cameras", tables.cameras.size()));
    }
  }
  const glm::vec3 low(box.low), high(box.high);
  for (const View& view : views) {
    find_in_view(view, tables.cameras[view.camera], tables.rays, frames[view.camera].depth, low, high, out);
  }
}

std::vector<SkinPoint> find_skin(std::span<const Camera> cameras, std::span<const DepthFrame> frames, const Box& box) {
  const RayTables tables = make_rays(cameras);
  std::vector<View> views;
  plan_views(cameras, tables, box, views);
  std::vector<SkinPoint> out;
  find_skin(tables, frames, box, views, out);
  return out;
}

std::uint32_t skin_groups(const RayTables& tables) {
  std::uint32_t groups = 0;
  for (const CameraTable& table : tables.cameras) {
    groups += gpu::groups_for(std::uint64_t{table.pitch} * table.height / block_pixels, group_blocks);
  }
  return groups;
}

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

SkinMemory::SkinMemory(const gpu::Device& device, const RayTables& tables)
    : runs(device, std::uint64_t{skin_groups(tables)} * skin_group_runs * sizeof(shader::SkinRun), "skin runs"),
      counts(device, std::uint64_t{skin_groups(tables)} * sizeof(std::uint32_t), "skin counts"),
      points(device, tables.pixels * sizeof(SkinPoint), "skin points"),
      total(device, sizeof(shader::ScanTotal), "skin total") {}

SkinPass::Kernels::Kernels(const gpu::Device& device, std::uint32_t rays_from_table)
    : count(device, "skin count", spirv::skin_count_comp,
            {shader::skin_count_buffers, sizeof(shader::SkinPush), std::span(&rays_from_table, 1)}),
      scatter(device, "skin scatter", spirv::skin_scatter_comp,
              {shader::skin_scatter_buffers, sizeof(shader::SkinPush), std::span(&rays_from_table, 1)}) {}

SkinPass::SkinPass(const gpu::Device& device) : pinhole_(device, 0), table_(device, 1), scan_(device) {}

void SkinPass::record(VkCommandBuffer commands, const SkinBuffers& buffers, const RayTables& tables, const Box& box,
                      std::span<const View> views, gpu::Timestamps* times) const {
  const auto kernels = [&](const View& view) -> const Kernels& {
    return tables.cameras[view.camera].pinhole ? pinhole_ : table_;
  };
  std::uint32_t groups = 0;
  for (const View& view : views) {
    shader::SkinPush push = push_of(view, tables.cameras[view.camera], box);
    push.first_group = groups;
    kernels(view).count.dispatch(commands, {buffers.depth, buffers.rays, buffers.runs, buffers.counts}, push,
                                 view_groups(view));
    groups += view_groups(view);
  }
  gpu::compute_to_compute(commands);  // counts -> scan
  if (times) times->mark(commands, "skin count");

  const auto room = static_cast<std::uint32_t>(buffers.points.size / sizeof(SkinPoint));
  scan_.record(commands, buffers.counts, {}, buffers.total, {groups, 1, room, 64});
  gpu::compute_to_compute(commands);  // scanned counts, runs -> scatter
  if (times) times->mark(commands, "skin scan");

  groups = 0;
  for (const View& view : views) {
    shader::SkinPush push = push_of(view, tables.cameras[view.camera], box);
    push.first_group = groups;
    kernels(view).scatter.dispatch(
        commands, {buffers.depth, buffers.rays, buffers.runs, buffers.counts, buffers.points}, push, view_groups(view));
    groups += view_groups(view);
  }
  if (times) times->mark(commands, "skin scatter");
}

}  // namespace palpa::sensing
