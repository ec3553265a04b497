// Skin points: the pixels of all depth frames that lie inside a box of the world, as points of the world.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scan.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/rays.hpp"

namespace palpa::sensing {

/// On the device one vec4: x, y, z and the index's bits.
struct SkinPoint {
  glm::vec3 position{};     ///< metres, world
  std::uint32_t index = 0;  ///< v * width + u, plus the pixels of the earlier cameras
};

/// C++ twin of SkinPass: the same points in the same order (camera, row, column), computed in float by the same
/// operations. `views` from plan_views(cameras, tables, box). Throws bad_usage unless there is one frame of the right
/// size per camera.
void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const View> views,
               std::vector<SkinPoint>& out);
/// The same, for one call: builds tables and views itself.
std::vector<SkinPoint> find_skin(std::span<const Camera> cameras, std::span<const DepthFrame> frames, const Box& box);

/// What one frame in flight needs on the device.
struct SkinBuffers {
  gpu::BufferRef depth;   ///< packed by pack_depth, 2 bytes per padded pixel
  gpu::BufferRef rays;    ///< upload_rays, 8 bytes per padded pixel
  gpu::BufferRef runs;    ///< scratch, 8 * skin_groups(tables) * skin_group_runs bytes
  gpu::BufferRef counts;  ///< scratch, 4 * skin_groups(tables) bytes
  gpu::BufferRef points;  ///< out: SkinPoint[], room for size / 16 of them, at most tables.pixels are written
  gpu::BufferRef total;   ///< out: shader::ScanTotal, points found and an indirect dispatch with 64 of them per group
};

/// Most groups that any box needs; each looks at skin_group_runs runs of 32 pixels.
inline constexpr std::uint32_t skin_group_runs = 64;
std::uint32_t skin_groups(const RayTables& tables);

/// Bytes of the packed depth frames, e.g. for a gpu::Upload.
inline std::uint64_t packed_bytes(const RayTables& tables) {
  return tables.padded_pixels * sizeof(std::uint16_t);
}

/// The rays in device memory, written once; blocks until they are there.
gpu::Buffer upload_rays(const gpu::Device& device, const RayTables& tables);

/// Scratch and output of one frame in flight, sized for every pixel of every camera.
struct SkinMemory {
  gpu::Buffer runs, counts, points, total;

  SkinMemory(const gpu::Device& device, const RayTables& tables);
  SkinBuffers with(gpu::BufferRef depth, gpu::BufferRef rays) const {
    return {depth, rays, runs.ref(), counts.ref(), points.ref(), total.ref()};
  }
};

/// Pipelines only; the caller owns buffers and command buffer.
class SkinPass {
 public:
  explicit SkinPass(const gpu::Device& device);

  /// Finds the skin points inside `box` (world, compared in float) from the views that plan_views gave for it.
  /// Barriers: expects depth and rays to be visible to compute, and earlier readers of runs, counts, points and total
  /// to be ordered before; inside it adds its own; the caller adds compute_to_compute (or writes_to_transfer)
  /// afterwards. With `times`, marks "skin count", "skin scan" and "skin scatter".
  void record(VkCommandBuffer commands, const SkinBuffers& buffers, const RayTables& tables, const Box& box,
              std::span<const View> views, gpu::Timestamps* times = nullptr) const;

 private:
  struct Kernels {
    Kernels(const gpu::Device& device, std::uint32_t rays_from_table);
    gpu::ComputePipeline count, scatter;
  };
  Kernels pinhole_, table_;  ///< cameras without and with distortion
  gpu::ScanPass scan_;
};

}  // namespace palpa::sensing
