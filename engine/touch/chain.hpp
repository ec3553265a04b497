// The whole of touching: skin points in, fingers with their foci out. On the device as one stretch of a command buffer,
// and as plain C++.
#pragma once

#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/buffer.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/skin.hpp"
#include "touch/bridge.hpp"
#include "touch/contacts.hpp"
#include "touch/fingers.hpp"
#include "touch/foci.hpp"
#include "touch/follow.hpp"
#include "touch/frames.hpp"
#include "touch/surface_tables.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The scene's solids on the device; built once for these parameters, read by every frame. Where the solids are is
/// uploaded with each frame (TouchBuffers::solids).
class SolidTable {
 public:
  /// Uploads and waits. Throws bad_usage as make_scene_table does, and failure where a buffer would be larger than the
  /// device takes.
  SolidTable(const gpu::Device& device, const std::vector<geometry::Solid>& solids, const Parameters& parameters = {});

  const SceneTable& host() const { return host_; }
  /// From the next record on; see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(host_, solid, T_world_rest); }
  /// See touch::touchable_box.
  Box box() const { return touchable_box(host_); }
  const SurfaceTables& surfaces() const { return surfaces_; }
  gpu::BufferRef cells() const { return cells_.ref(); }
  gpu::BufferRef planes() const { return planes_.ref(); }
  gpu::BufferRef borders() const { return borders_.ref(); }
  gpu::BufferRef foci_of() const { return foci_of_.ref(); }

 private:
  SceneTable host_;
  gpu::Upload cells_, planes_, borders_, foci_of_;
  SurfaceTables surfaces_;
};

/// Room for one frame in flight: 8 bytes of memory per point and 124 per contact, 43 MB for the defaults.
struct Capacity {
  std::uint32_t points = 1'250'000;  ///< at most shader::contacts_most_points
  std::uint32_t contacts = 262'144;  ///< more than this many contacts in a frame are an error that read() reports
  std::uint32_t deep = 0;            ///< the same for deep points: 32 bytes each
  bool inside = false;               ///< deep points may be clustered too: 156 bytes each
};

/// The same room, and as much for deep points as for contacts where the parameters want them.
Capacity capacity_for(const Parameters& parameters, Capacity capacity = {});

/// All buffers of one frame in flight, allocated once.
class TouchBuffers {
 public:
  /// Throws bad_usage for more points than fit.
  TouchBuffers(const gpu::Device& device, const Capacity& capacity);

  const Capacity& capacity() const { return capacity_; }
  /// For passes that go on from here: shader::TouchHeader, FingerRecord[max_fingers], FocusRecord[max_fingers *
  /// max_foci], ContactRecord[], of which the header says how many are valid.
  gpu::BufferRef header() const { return header_.ref(); }
  gpu::BufferRef fingers() const { return fingers_.ref(); }
  gpu::BufferRef foci() const { return foci_.ref(); }
  gpu::BufferRef contacts() const { return contacts_.ref(); }
  /// Where deep points were asked for: ContactRecord[], of which deep_total()'s shader::ScanTotal says how many.
  gpu::BufferRef deep() const { return deep_.ref(); }
  gpu::BufferRef deep_total() const { return deep_total_.ref(); }
  /// shader::SolidRecord[] as of the newest record: where the solids are.
  gpu::BufferRef solids() const { return solids_.ref(); }

 private:
  friend class TouchPasses;
  friend void read(const TouchBuffers& buffers, Touch& out);
  Capacity capacity_;
  gpu::Buffer hits_, masks_, counts_, total_, nodes_, keys_, places_, slots_, heads_, list_, groups_, crowded_, work_,
      parents_, clusters_, samples_, patches_, pairs_, bridge_work_, inside_, inside_total_, deep_masks_, deep_counts_,
      finger_counts_;
  gpu::Upload solids_;
  gpu::Readback contacts_, header_, fingers_, foci_, deep_, deep_total_;
  bool with_deep_ = false;  ///< of the newest record
  const gpu::Device* device_;
  Detail detail_ = Detail::contacts;  ///< of the newest record
};

/// Fingers of a frame captured at `time_s` are followed from the frames recorded before with the same tracks; without
/// tracks each frame stands alone.
struct Following {
  TrackBuffer* tracks = nullptr;
  double time_s = 0;
};

/// All pipelines; one for any number of frames in flight.
class TouchPasses {
 public:
  explicit TouchPasses(const gpu::Device& device);

  /// Records fourteen dispatches, four more with `sight`, one more with tracks to follow, and the readback. `points`
  /// holds a vec4 per skin point (x, y, z, the bits of its index, indices ascending), `total` their shader::ScanTotal
  /// with 64 per group. With `sight`, fingers are joined across hidden skin: then indices are pixels of the pictures.
  /// With `times`, marks the passes' stages and "foci". Barriers: expects points and total to be visible to compute and
  /// as indirect arguments, and the submit that used `buffers` before to have completed. Throws bad_usage on unusable
  /// parameters.
  void record(VkCommandBuffer commands, const SolidTable& table, TouchBuffers& buffers, gpu::BufferRef points,
              gpu::BufferRef total, const Parameters& parameters, gpu::Timestamps* times = nullptr,
              Detail detail = Detail::contacts, const SightBuffers* sight = nullptr,
              const Following& following = {}) const;

 private:
  ContactsPass contacts_;
  FingersPass fingers_;
  BridgePass bridge_;
  FramesPass frames_;
  FollowPass follow_;
  FociPass foci_;
};

inline void record(VkCommandBuffer commands, const TouchPasses& passes, const SolidTable& table, TouchBuffers& buffers,
                   gpu::BufferRef points, gpu::BufferRef total, const Parameters& parameters,
                   gpu::Timestamps* times = nullptr, Detail detail = Detail::contacts) {
  passes.record(commands, table, buffers, points, total, parameters, times, detail);
}

/// What the newest record found, once its submit has completed. Where it was recorded with Detail::fingers, contacts
/// (the touch's and the fingers') are empty. Allocates only where `out` grows beyond what it has
/// held. Throws failure() naming the figure when there were more points or contacts than `buffers` has room for.
void read(const TouchBuffers& buffers, Touch& out);

/// The twin of the whole: find_contacts, find_fingers, find_frames, with `tracks` follow_fingers, find_foci. Throws
/// bad_usage as they do.
void touch_points(std::span<const sensing::SkinPoint> points, const SceneTable& table, const Parameters& parameters,
                  Touch& out, Tracks* tracks = nullptr, double time_s = 0);
/// The same for points whose index is their place.
void touch_points(std::span<const glm::vec3> points, const std::vector<geometry::Solid>& solids,
                  const Parameters& parameters, Touch& out);

}  // namespace palpa::touch
