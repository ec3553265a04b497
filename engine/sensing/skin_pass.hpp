// Skin points on the device: the pixels of all depth frames as points in the world, if they lie inside a box and not on
// something that the rig knows, such as a board.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scan_pass.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "sensing/surroundings.hpp"

namespace palpa::sensing {

struct SkinBindings {
  gpu::BufferRef depth;   ///< in: packed by pack_depth, 2 bytes per padded pixel
  gpu::BufferRef rays;    ///< in: upload_rays, 8 bytes per padded pixel
  gpu::BufferRef points;  ///< out: SkinPoint[], room for size / 16 of them; at most tables.pixels are written
  gpu::BufferRef total;   ///< out: shader::ScanTotal, the number of points and an indirect dispatch over them
  gpu::BufferRef
      volumes;            ///< in: shader::SkinVolume[], what plan_drops found for the box; read only if `drops` says so
  gpu::BufferRef limits;  ///< in: upload_limits
  gpu::BufferRef dropped;  ///< out: 4 counters by NoSkin
};

/// Bytes of the packed depth frames, e.g. for a gpu::Upload.
inline std::uint64_t packed_bytes(const RayTables& tables) {
  return tables.padded_pixels * sizeof(std::uint16_t);
}

/// The rays in device memory, written once; blocks until they are uploaded.
gpu::Buffer upload_rays(const gpu::Device& device, const RayTables& tables);

/// The backgrounds' limits in device memory, in the same way.
gpu::Buffer upload_limits(const gpu::Device& device, const RayTables& tables);

/// Holds only pipelines; the caller owns memory and command buffer.
class SkinPass {
 public:
  explicit SkinPass(const gpu::Device& device) : device_(&device) {}

  /// Creates the pipelines that these cameras need; existing ones stay. `surrounded`: there may be volumes.
  void prepare(const RayTables& tables, bool surrounded = false);

  /// Sizes that suffice for any box.
  static std::vector<gpu::ScratchBuffer> scratch(const RayTables& tables);

  /// Finds the skin points inside `box` (world, compared in float) from the crops that plan_crops made for it, and
  /// drops and counts those in the first `volumes` of the bound list. The total's indirect dispatch is divided as
  /// `groups` says.
  /// Barriers: expects depth and rays to be visible to compute, and earlier readers of points and total to be ordered
  /// before; the volumes likewise; adds its own barriers inside; the caller adds compute_to_compute (or
  /// writes_to_transfer) afterwards. With `times`, marks "skin count", "skin scan" and "skin scatter".
  void record(VkCommandBuffer commands, const SkinBindings& bindings, const gpu::Scratch& scratch,
              const RayTables& tables, const Box& box, std::span<const Crop> crops, const shader::ScanGroups& groups,
              gpu::Timestamps* times = nullptr, std::size_t volumes = 0) const;

 private:
  enum ScratchIndex : std::size_t { runs, counts, offsets, scratch_count };
  struct Kernels {
    std::array<gpu::ComputePipeline, 4> count;  ///< by what they drop
    gpu::ComputePipeline scatter;
  };
  void make(Kernels& kernels, std::uint32_t rays_from_table, std::uint32_t drops) const;

  const gpu::Device* device_;
  Kernels pinhole_, table_;  ///< for CameraTable::pinhole, and for all other cameras
  std::optional<gpu::ScanPass> scan_;
};

}  // namespace palpa::sensing
