// From frames of skin to plans: what a session computes, one frame after the other, several under way at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/math.hpp"
#include "gpu/device.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "session/links/plan.hpp"
#include "session/plan/setting.hpp"
#include "session/watch/effort.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// One frame of skin. Nothing of it is kept.
struct SkinFrame {
  std::span<const sensing::DepthFrame> images{};  ///< of a session with cameras: one of each
  std::span<const sensing::SkinPoint> points{};   ///< of one without: indices ascend
  std::uint64_t sequence = 0;
  double time_s = 0;      ///< capture, on the source's clock
  double captured_s = 0;  ///< the same on the loop's clock
  double arrived_s = 0;   ///< in memory, on the loop's clock
};

/// What became of a frame besides its plan. Valid until the planner's next step.
struct FrameReport {
  std::uint64_t sequence = 0;
  double time_s = 0;  ///< capture, on the source's clock
  const touch::Touch* touch = nullptr;
  std::span<const gpu::PassTime> passes;  ///< in the order they ran, on the device or of the C++ twins
  double arrived_s = 0, planned_s = 0;    ///< on the loop's clock: frame in memory, drives in memory
};

class Planner {
 public:
  virtual ~Planner() = default;
  /// Whether another frame can be started before a step.
  virtual bool can_start() const = 0;
  /// Whether frames are under way.
  virtual bool busy() const = 0;
  /// Takes a frame in.
  virtual void start(const SkinFrame& frame) = 0;
  /// Brings the oldest frame under way one stage further, waiting for the device where it must. True when its plan is
  /// complete.
  virtual bool step(Plan& plan, FrameReport& report) = 0;
  /// Lets the device get ready for every frame to come: drivers compile a kernel when it is first dispatched, which
  /// takes seconds where no cache has it. Changes nothing that frames compute; does nothing after the first of them.
  virtual void warm_up() {}
  /// From the next start on frames are worked on with that effort. What can be shed at all; by default nothing.
  virtual void set_effort(const Effort&) {}
  virtual Effort most_shed() const { return {}; }
  /// From the next start on; see touch::Stage::set_pose.
  virtual void set_pose(std::uint32_t solid, const Transform& T_world_rest) = 0;
};

/// Passes on the device. For a live setting two frames in flight, and a frame that exceeds its room is left out with a
/// warning; else one, and it is an error. `device`, `setting` and `scheduler` outlive it. Throws Error where the device
/// is lost.
std::unique_ptr<Planner> make_gpu_planner(const gpu::Device& device, const SessionSetting& setting,
                                          Scheduler& scheduler);
/// The same through the passes' C++ twins.
std::unique_ptr<Planner> make_host_planner(const SessionSetting& setting, Scheduler& scheduler);

/// Gives a touch all the room that a live frame needs: any number of fingers and foci, `contacts_per_finger` contacts
/// (a finger that ever has more grows once), and deep points as many as a frame in flight has room for.
inline constexpr std::size_t contacts_per_finger = 4096;
inline constexpr std::uint32_t most_deep = 1U << 18;
void reserve(touch::Touch& touch);

/// What the stage is for, on the device or through its twins: of single frames, of events and of methods that look at
/// contacts it gives these, too; events look at deep points.
touch::StageSetting stage_setting(const SessionSetting& setting, const Scheduler& scheduler);

}  // namespace palpa::session
