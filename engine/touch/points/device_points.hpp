// Points on a device.
//
//   SkinPass      skin_count, scan, skin_scatter: pixels -> points (world x, y, z, pixel) and their total
//   ContactsPass  contacts_find or contacts_surface (by the scene's solids), contacts_pack: points -> contacts,
//                 Eq. (1), and deep points if requested
//   ClustersPass  clusters_*: contacts -> parents (per contact its cluster), header (how many clusters, points and
//                 contacts), selected (per cluster that may be a finger: its first contact, solid, contacts)
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/commands.hpp"
#include "gpu/scratch.hpp"
#include "gpu/texel_view.hpp"
#include "gpu/timestamps.hpp"
#include "touch/capacity.hpp"
#include "touch/contacts/solids_memory.hpp"
#include "touch/points/passes.hpp"
#include "touch/points/points.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::touch {

/// Solids and rays on the device, and the memory of the frame in progress.
class DevicePoints : public Points {
 public:
  /// `passes`, `tables` and `solids` must outlive it. Gets the pipelines that it needs from `passes`. Uploads and
  /// waits. Allocates the memory for every frame if there are cameras or if the setting gives the number of points;
  /// otherwise start() allocates it, in powers of two. Takes 8 bytes per point and 148 per contact (49 MB for three
  /// cameras of 848x480), plus 32 per deep point, or 180 if deep points are clustered. Throws bad_usage for more points
  /// than any frame can have, and failure if a table is larger than the device allows.
  DevicePoints(Passes& passes, const sensing::RayTables& tables, const PreparedSolids& solids,
               const StageSetting& setting);

  /// Copies images and points. Allocates nothing unless there are more points than before. Throws bad_usage for images
  /// that do not fit the cameras, or for more points than there is room for.
  void start(const Skin& skin) override;
  /// The names of the passes' times: those of SkinPass (depth frames only), ContactsPass and ClustersPass. Allocates
  /// only if `out` grows. Throws failure if the device is lost, or if the frame has more points, contacts or deep
  /// points than there is room for.
  void finish(Touch& out, std::vector<gpu::PassTime>& times) override;

  const Capacity& capacity() const { return capacity_; }

 private:
  void make(const Capacity& capacity);
  void set(std::span<const sensing::SkinPoint> points);
  void record(VkCommandBuffer commands, const Skin& skin);
  void record_skin(VkCommandBuffer commands, const Skin& skin);
  void record_readback(VkCommandBuffer commands) const;
  std::uint32_t deep_count() const;
  void check_capacity() const;
  void read_rest();

  const Passes& passes_;
  const sensing::RayTables& tables_;
  const PreparedSolids& solids_;
  StageSetting setting_;
  gpu::Buffer rays_, limits_;
  SolidsMemory solids_memory_;

  Capacity capacity_;
  gpu::Upload depth_;           // depth frames
  gpu::Upload points_, given_;  // or points, and their total
  gpu::Upload volumes_;
  gpu::Readback dropped_;
  gpu::Upload reach_;              // ReachTable
  gpu::Upload poses_;              // of the solids
  gpu::Buffer seen_, seen_total_;  // skin points of depth frames
  gpu::Buffer total_, clusters_;
  gpu::Scratch skin_scratch_, contacts_scratch_, clusters_scratch_;
  gpu::Readback contacts_, parents_, deep_, deep_total_, header_, selected_;
  gpu::TexelView contact_texels_, pose_texels_;
  gpu::Timestamps times_;
  std::vector<gpu::PassTime> read_times_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
  std::uint64_t submitted_ = 0;
};

}  // namespace palpa::touch
