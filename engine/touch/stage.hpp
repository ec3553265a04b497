// The complete stage of a frame: from skin to points, contacts and clusters (points/points.hpp, on a device or on the
// host), and from clusters to fingers with foci (fingers/fingers.hpp, always on the host).
//
//   touch::Stage stage(solids, cameras, setting);          // on the host
//   touch::Passes passes(device);                          // or on a device (points/passes.hpp); one for all stages
//   touch::Stage stage(passes, solids, cameras, setting);
//   ... for each frame:
//   stage.start(images, time_s);                           // on a device, returns at once
//   stage.finish(touch);
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/joints/capsules.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/fingers/fingers.hpp"
#include "touch/points/points.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

class Passes;

/// One stream of frames, one frame at a time. Does not move.
class Stage {
 public:
  /// On the host, with room for any frame. Without cameras, every frame is a set of skin points. Throws bad_usage for
  /// invalid solids, cameras and parameters (prepare_solids, make_rays, check_parameters).
  explicit Stage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
                 const StageSetting& setting = {})
      : Stage(nullptr, solids, cameras, setting) {}
  /// The same with the points on a device (points/device_points.hpp has the limits). `passes` must outlive the stage
  /// and gets the pipelines that it needs. Uploads and waits. Throws failure if a table is larger than the device
  /// allows.
  Stage(Passes& passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
        const StageSetting& setting = {})
      : Stage(&passes, solids, cameras, setting) {}
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const StageSetting& setting() const { return setting_; }
  const std::vector<sensing::Camera>& cameras() const { return cameras_; }
  const sensing::RayTables& rays() const { return tables_; }
  const PreparedSolids& solids() const { return solids_; }
  /// Takes effect from the next start(); see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(solids_, solid, T_world_rest); }

  /// From the next start() on, only every n-th pixel of every n-th row becomes a skin point. 1 (the default): all
  /// pixels.
  void set_pixel_stride(std::uint32_t stride) { stride_ = stride; }
  /// The largest valid stride (touch::most_pixel_stride), for the solids in their current poses.
  std::uint32_t most_pixel_stride() const;

  /// The next frame is followed as if none had come before.
  void forget() { fingers_.forget(); }
  /// See Fingers.
  std::uint32_t next_id() const { return fingers_.next_id(); }
  void number_from(std::uint32_t id) { fingers_.number_from(id); }

  /// Starts the frame captured at `time_s`: one image per camera, which must stay as they are until finish(), or points
  /// with ascending indices. If fingers are followed, frames must come in the order of their capture. Throws bad_usage
  /// for images that do not fit the cameras.
  void start(std::span<const sensing::DepthFrame> images, double time_s = 0);
  void start(std::span<const sensing::SkinPoint> points, double time_s = 0);
  /// The same for the hands of a tracker: their skin near the solids (sensing/joints/capsules.hpp), within the room.
  void start(std::span<const sensing::Capsule> hands, double time_s = 0);
  /// Completes the frame that was started. On a device, throws failure if the frame has more points or contacts than
  /// there is room for, or if the device is lost; the next frame is then followed as if none had come before. The same
  /// for hands with more than sensing::most_hand_points.
  void finish(Touch& out);
  /// Both.
  template <typename T>
  void touch(std::span<const T> skin, Touch& out, double time_s = 0) {
    start(skin, time_s);
    finish(out);
  }
  void touch(const std::vector<sensing::DepthFrame>& images, Touch& out, double time_s = 0) {
    touch(std::span(images), out, time_s);
  }
  void touch(const std::vector<sensing::SkinPoint>& points, Touch& out, double time_s = 0) {
    touch(std::span(points), out, time_s);
  }

  /// The times of the parts of the frame that was finished last, in their order: those of Points, then those of
  /// Fingers.
  std::span<const gpu::PassTime> times() const { return times_; }

 private:
  Stage(Passes* passes, const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras,
        const StageSetting& setting);
  void start(Skin skin, double time_s);

  StageSetting setting_;
  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  PreparedSolids solids_;
  std::unique_ptr<Points> points_;
  Fingers fingers_;
  std::uint32_t stride_ = 1;
  // The frame in progress.
  FingerOptions parameters_;
  std::span<const sensing::DepthFrame> images_;
  std::vector<sensing::Crop> crops_;
  std::vector<shader::SkinVolume> volumes_;
  std::vector<sensing::SkinPoint> hand_skin_;
  bool too_large_ = false;  ///< the hands have too much skin
  std::vector<gpu::PassTime> times_;
};

}  // namespace palpa::touch
