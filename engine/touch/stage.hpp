// The stage of a frame from skin to foci, in one piece: depth frames, or skin points from elsewhere, in; contacts,
// fingers and foci out. What all frames share is apart from what each frame in flight writes to. HostStage
// (host_stage.hpp) is its twin.
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
// The passes in the order of record(), each with its kernels (NAME.comp in shaders/touch/) and what it writes. A point
// goes on as a contact, a contact as a member of a finger, a finger as foci. Split and bridge look at the depth frames
// again and run where there are cameras and a finger width; follow and glide know of the frames before and run where
// fingers are followed and foci smoothed.
//
//   SkinPass      skin_count, scan, skin_scatter: pixels -> points (world x, y, z, pixel) and their total
//   ContactsPass  contacts_find or contacts_surface (by the scene's solids), contacts_pack: points -> contacts,
//                 Eq. (1), and deep points where asked for
//   FingersPass   fingers_*: contacts -> parents (per contact its cluster), clusters (size, smallest contact),
//                 header (how many fingers; points and contacts in all), fingers' first, solid, contacts
//   SplitPass     split_*: parents, clusters, header, fingers anew where a cluster is several fingers, or none
//   BridgePass    bridge_*: the same where clusters are one finger
//   SectionsPass  sections_*: contacts' finger, grouped (contacts by finger); fingers' centre, mean, axes, turn, lean,
//                 point_like, id (its index); Eq. (2)-(4)
//   FollowPass    follow: fingers' id, axes, turn; tracks
//   FociPass      foci: foci (sectors' centroids, contacts per sector), Eq. (5)-(7); fingers' foci (how many)
//   GlidePass     glide: foci smoothed over time, also of sectors that are empty; fingers' placed, held; homes
//
// read() makes a Touch of header, fingers, foci and, where asked for, contacts and deep points; types.hpp says what
// each means.
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

/// Solids, rays and tracks on the device; one for any number of frames in flight. Stays where it is as long as there is
/// a StageMemory of it.
class Stage {
 public:
  /// Without cameras every frame is a set of skin points. `passes` outlives the stage and gets the pipelines that these
  /// solids, cameras and setting need. Uploads and waits. Throws bad_usage on solids, cameras and parameters that
  /// cannot be used (prepare_solids, make_rays, check_parameters), failure where a table is larger than the device
  /// takes.
  Stage(Passes& passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
        const StageSetting& setting = {});
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const StageSetting& setting() const { return setting_; }
  const std::vector<sensing::Camera>& cameras() const { return cameras_; }
  const PreparedSolids& solids() const { return solids_; }
  /// From the next record on the solid is where T_world_rest takes it; see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(solids_, solid, T_world_rest); }

  /// From the next record on only every n-th pixel of every n-th row becomes a skin point; 1, as at first: all do.
  void set_pixel_stride(std::uint32_t stride) { stride_ = stride; }
  /// How large that may be, see touch::most_pixel_stride. Of solids where they are now.
  std::uint32_t most_pixel_stride() const;

  /// Records all that turns the frame's input, captured at `time_s`, into foci, and the readback that the setting asks
  /// for. Where fingers are followed: record frames in the order of their capture, and submit them in the order of
  /// their recording. With `times`, marks the names of SkinPass (depth frames only), ContactsPass, FingersPass,
  /// "split", "bridge", SectionsPass, "follow", "foci" and "glide", those that run. Barriers: the submit that used
  /// `memory` before has completed. Allocates nothing.
  void record(VkCommandBuffer commands, StageMemory& memory, double time_s = 0, gpu::Timestamps* times = nullptr);

 private:
  friend class StageMemory;
  void record_skin(VkCommandBuffer commands, StageMemory& memory, gpu::Timestamps* times) const;

  const Passes& passes_;
  StageSetting setting_;
  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  gpu::Buffer rays_;
  gpu::Upload bridge_cameras_, borders_;
  PreparedSolids solids_;
  SolidsMemory solids_memory_;
  std::optional<TracksMemory> tracks_;
  std::optional<HomesMemory> homes_;
  std::uint32_t stride_ = 1;
};

/// What one frame in flight reads and writes. Give it its input, record, submit, wait, read.
class StageMemory {
 public:
  /// Takes the memory for every frame with cameras, or where the setting says how many points there are; else set()
  /// does. Throws bad_usage for more points than any frame can have. 8 bytes per point and 164 per contact, 53 MB for
  /// three cameras of 848x480; per deep point 32, and 196 where they are clustered.
  explicit StageMemory(const Stage& stage);

  /// The input of the next record: one image per camera, or points whose indices ascend. The submit that used this
  /// memory before has completed. The images and points are copied. Throws bad_usage for images that do not fit the
  /// cameras, or for more points than there is room for. Allocates where points are more than there were before, in
  /// powers of two.
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
  gpu::Upload solids_;             // where they are
  gpu::Buffer seen_, seen_total_;  // skin points of depth frames
  gpu::Buffer total_, parents_, clusters_, grouped_;
  gpu::Scratch skin_scratch_, contacts_scratch_, fingers_scratch_, split_scratch_, bridge_scratch_, sections_scratch_;
  gpu::Readback contacts_, deep_, deep_total_, header_, fingers_, foci_;
  gpu::TexelView contact_texels_, solid_texels_, grouped_texels_;
};

/// What the newest record found, once its submit has completed, with each finger's depth (find_depths). With
/// Detail::fingers, contacts (the touch's and the fingers') are empty. Allocates only where `out` grows beyond what it
/// has held. Throws failure naming the figure when there were more points or contacts than there is room for.
void read(const StageMemory& memory, Touch& out);

}  // namespace palpa::touch
