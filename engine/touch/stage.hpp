// The stage of a frame from skin to foci, in one piece: depth frames, or skin points from elsewhere, in; contacts,
// fingers and foci out. What all frames share is apart from what each frame in flight writes to.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/buffer.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin.hpp"
#include "touch/chain.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

class StageFrame;

/// Solids, rays and pipelines on the device; one for any number of frames in flight. `device` outlives it.
class Stage {
 public:
  /// Without cameras every frame is a set of skin points. The solids are prepared for delta and deep points of
  /// `parameters`. Uploads and waits. Throws as SolidTable and make_rays do.
  Stage(const gpu::Device& device, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
        const Parameters& parameters = {});

  const SolidTable& solids() const { return solids_; }
  /// From the next record on the solid is where T_world_rest takes it; see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { solids_.set_pose(solid, T_world_rest); }
  const std::vector<sensing::Camera>& cameras() const { return cameras_; }

  /// Records all that turns the frame's input into foci, and the readback that `detail` asks for. With `times`, marks
  /// the names of SkinPass (depth frames only) and TouchPasses. With `following`, fingers keep their ids and axes:
  /// record frames in the order of their capture, and submit them in the order of their recording. Barriers: the
  /// submit that used `frame` before has completed. Allocates nothing; throws bad_usage on unusable parameters.
  void record(VkCommandBuffer commands, StageFrame& frame, const Parameters& parameters, Detail detail,
              gpu::Timestamps* times = nullptr, const Following& following = {}) const;

 private:
  friend class StageFrame;
  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  gpu::Buffer rays_;
  gpu::Upload bridge_cameras_;
  bool deep_ = false;
  SolidTable solids_;
  sensing::SkinPass skin_pass_;
  TouchPasses touch_passes_;
};

/// What one frame in flight reads and writes. Give it its input, record, submit, wait, read.
class StageFrame {
 public:
  /// Room for all pixels of the stage's cameras, else for `capacity.points` skin points; and for `capacity.contacts`;
  /// where the stage was made for deep points, for `capacity.deep` of them, else 65,536.
  StageFrame(const gpu::Device& device, const Stage& stage, Capacity capacity = {});

  /// The input of the next record: one image per camera, or points whose indices ascend. The images and points are
  /// copied. Throws bad_usage for images that do not fit the cameras, or for more points than there is room for.
  void set(std::span<const sensing::DepthFrame> images);
  void set(std::span<const sensing::SkinPoint> points);

  /// For passes that go on from here.
  const TouchBuffers& buffers() const { return touch_; }

 private:
  friend class Stage;
  const sensing::RayTables* tables_;
  std::vector<sensing::View> views_;
  gpu::Upload depth_;
  std::optional<sensing::SkinMemory> skin_;
  gpu::Upload points_, total_;
  TouchBuffers touch_;
};

/// What the newest record found, once its submit has completed; as read() of its buffers.
inline void read(const StageFrame& frame, Touch& out) {
  read(frame.buffers(), out);
}

/// The twin of the stage: the passes' C++ twins on the calling thread.
class HostStage {
 public:
  /// Called after each part with its name: "skin", "contacts", "fingers", "bridge", "frames",
  /// "follow", "foci".
  using Mark = std::function<void(const char*)>;

  /// Throws as make_scene_table and make_rays do.
  HostStage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
            const Parameters& parameters = {});

  const SceneTable& solids() const { return table_; }
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(table_, solid, T_world_rest); }

  /// With `tracks`, follows the fingers of the calls before to this frame, captured at `time_s`. Throws bad_usage for
  /// images that do not fit the cameras, and on unusable parameters.
  void touch(std::span<const sensing::DepthFrame> images, const Parameters& parameters, Touch& out,
             const Mark& mark = {}, Tracks* tracks = nullptr, double time_s = 0);
  void touch(std::span<const sensing::SkinPoint> points, const Parameters& parameters, Touch& out,
             const Mark& mark = {}, Tracks* tracks = nullptr, double time_s = 0);

 private:
  void touch(std::span<const sensing::SkinPoint> points, const Sight* sight, const Parameters& parameters, Touch& out,
             const Mark& mark, Tracks* tracks, double time_s) const;

  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  std::vector<shader::BridgeCamera> bridge_cameras_;
  SceneTable table_;
  std::vector<sensing::View> views_;        // scratch
  std::vector<sensing::SkinPoint> points_;  // scratch
};

}  // namespace palpa::touch
