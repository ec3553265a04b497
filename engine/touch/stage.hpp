// The complete stage of a frame from skin to foci. The input is depth frames, or skin points from another source. The
// output is contacts, fingers and foci. Data that all frames share is separate from data that each frame in flight
// writes. HostStage (host_stage.hpp) is its twin.
//
//   touch::Passes passes(device);                       // one for all stages of the device
//   touch::Stage stage(passes, solids, cameras, setting);
//   touch::StageMemory memory(stage);                   // one for each frame in flight
//   ... for each frame:
//   memory.set(images);
//   stage.record(recorder.begin(), memory, time_s);
//   timeline.wait(timeline.submit(recorder.end()));
//   touch::read(memory, touch);
//
// The passes in the order of record(), each with its kernels (NAME.comp in shaders/touch/) and what it writes. Points
// become contacts, contacts become members of a finger, and fingers become foci. Split and bridge look at the depth
// frames again; they run if there are cameras and a finger width. Follow and glide use data of earlier frames; they run
// if fingers are followed and foci are smoothed.
//
//   SkinPass      skin_count, scan, skin_scatter: pixels -> points (world x, y, z, pixel) and their total
//   ContactsPass  contacts_find or contacts_surface (by the scene's solids), contacts_pack: points -> contacts,
//                 Eq. (1), and deep points if requested
//   FingersPass   fingers_*: contacts -> parents (per contact its cluster), clusters (size, smallest contact),
//                 header (how many fingers; points and contacts in all), fingers' first, solid, contacts
//   SplitPass     split_*: rewrites parents, clusters, header, fingers if a cluster is several fingers, or no finger
//   BridgePass    bridge_*: the same if several clusters are one finger
//   KnownPass     known_claim, known_admit: rewrites header and fingers by the fingers of the frame before;
//                 known_keep, after follow: known
//   SectionsPass  sections_*: contacts' finger, grouped (contacts by finger); fingers' centre, mean, axes, turn, lean,
//                 point_like, id (its index); Eq. (2)-(4)
//   FollowPass    follow: fingers' id, axes, turn; tracks
//   FociPass      foci: foci (sectors' centroids, contacts per sector), Eq. (5)-(7); fingers' foci (how many)
//   GlidePass     glide: foci smoothed over time, including those of empty sectors; fingers' placed, held; homes
//
// read() makes a Touch from header, fingers and foci, and from contacts and deep points if requested; types.hpp
// explains them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/buffer.hpp"
#include "gpu/scratch.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/contacts/solids_memory.hpp"
#include "touch/passes.hpp"
#include "touch/room.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

class StageMemory;

/// Solids, rays and tracks on the device; one object for any number of frames in flight. Must not move while a
/// StageMemory refers to it.
class Stage {
 public:
  /// Without cameras, every frame is a set of skin points. `passes` must outlive the stage and gets the pipelines that
  /// these solids, cameras and setting need. Uploads and waits. Throws bad_usage for invalid solids, cameras and
  /// parameters (prepare_solids, make_rays, check_parameters), and failure if a table is larger than the device allows.
  Stage(Passes& passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
        const StageSetting& setting = {});
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const StageSetting& setting() const { return setting_; }
  const std::vector<sensing::Camera>& cameras() const { return cameras_; }
  const sensing::RayTables& rays() const { return tables_; }
  const PreparedSolids& solids() const { return solids_; }
  /// Takes effect from the next record(); see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(solids_, solid, T_world_rest); }

  /// From the next record() on, only every n-th pixel of every n-th row becomes a skin point. 1 (the default): all
  /// pixels.
  void set_pixel_stride(std::uint32_t stride) { stride_ = stride; }
  /// The largest valid stride (touch::most_pixel_stride), for the solids in their current poses.
  std::uint32_t most_pixel_stride() const;

  /// The next frame is followed as if none had come before.
  void forget() {
    if (tracks_) tracks_->clock = {};
  }

  /// Records all passes that turn the frame's input, captured at `time_s`, into foci, and the readback that the setting
  /// requests. If fingers are followed, record frames in the order of their capture and submit them in the order of
  /// recording. With `times`, marks the names of SkinPass (depth frames only), ContactsPass, FingersPass, "split",
  /// "bridge", "admit", SectionsPass, "follow", "keep", "foci" and "glide", as far as they run. Barriers: the previous
  /// submit that used `memory` must have completed. Allocates nothing.
  void record(VkCommandBuffer commands, StageMemory& memory, double time_s = 0, gpu::Timestamps* times = nullptr);

 private:
  friend class StageMemory;
  void record_skin(VkCommandBuffer commands, StageMemory& memory, gpu::Timestamps* times) const;

  const Passes& passes_;
  StageSetting setting_;
  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  gpu::Buffer rays_, limits_;
  gpu::Upload bridge_cameras_, borders_;
  PreparedSolids solids_;
  SolidsMemory solids_memory_;
  std::optional<TracksMemory> tracks_;
  std::optional<HomesMemory> homes_;
  std::optional<KnownMemory> known_;  // if depth frames decide which clusters are fingers
  std::uint32_t stride_ = 1;
};

/// The data that one frame in flight reads and writes. Use: set the input, record, submit, wait, read.
class StageMemory {
 public:
  /// Allocates the memory for every frame if there are cameras or if the setting gives the number of points; otherwise
  /// set() allocates it. Throws bad_usage for more points than any frame can have. Takes 8 bytes per point and 164 per
  /// contact (53 MB for three cameras of 848x480), plus 32 per deep point, or 196 if deep points are clustered.
  explicit StageMemory(const Stage& stage);

  /// The input of the next record(): one image per camera, or points with ascending indices. The previous submit that
  /// used this memory must have completed. The images and points are copied. Throws bad_usage for images that do not
  /// fit the cameras, or for more points than there is room for. Allocates, in powers of two, if there are more points
  /// than before.
  void set(std::span<const sensing::DepthFrame> images);
  void set(std::span<const sensing::SkinPoint> points);

  const Room& room() const { return room_; }

 private:
  friend class Stage;
  friend void read(const StageMemory& memory, Touch& out);
  void make(const Room& room);

  const Stage* stage_;
  Room room_;
  gpu::Upload depth_;           // depth frames
  gpu::Upload points_, given_;  // or points, and their total
  std::vector<sensing::Crop> crops_;
  std::vector<shader::SkinVolume> drops_;
  gpu::Upload volumes_;
  gpu::Readback dropped_;
  gpu::Upload solids_;             // their poses
  gpu::Buffer seen_, seen_total_;  // skin points of depth frames
  gpu::Buffer total_, parents_, clusters_, grouped_;
  gpu::Scratch skin_scratch_, contacts_scratch_, fingers_scratch_, split_scratch_, bridge_scratch_, known_scratch_,
      sections_scratch_;
  gpu::Readback contacts_, deep_, deep_total_, header_, fingers_, foci_;
  gpu::TexelView contact_texels_, solid_texels_, grouped_texels_;
};

/// Reads the result of the newest record(), after its submit has completed, and adds each finger's depth (find_depths).
/// With Detail::fingers, the contacts of the touch and of the fingers are empty. Allocates only if `out` grows beyond
/// its previous size. Throws failure with the number if there were more points or contacts than there is room for.
void read(const StageMemory& memory, Touch& out);

}  // namespace palpa::touch
