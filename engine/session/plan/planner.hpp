// From frames of skin to plans: the computation of a session. Frames are processed in order, several at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "base/math.hpp"
#include "gpu/device.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "session/plan/finger_sounds.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/setting.hpp"
#include "session/predict/predictor.hpp"
#include "session/predict/slot_clock.hpp"
#include "session/watch/effort.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// One frame of skin. Images, capsules and points must stay as they are until the planner's first step of this frame.
struct SkinFrame {
  std::span<const sensing::DepthFrame> images{};  ///< for a session with cameras: one per camera
  std::span<const sensing::Capsule> capsules{};   ///< for a session with a tracker: bones of all hands, world
  bool in_doubt = false;                          ///< the same: hands were left out because they may be wrong
  std::span<const sensing::SkinPoint> points{};   ///< for a session with neither: indices ascend
  std::uint64_t sequence = 0;
  double time_s = 0;      ///< capture, on the source's clock
  double captured_s = 0;  ///< the same on the loop's clock
  double arrived_s = 0;   ///< in memory, on the loop's clock
  /// One of these, or neither, says when the plan's slots will sound: the loop's clock, which must outlive the frame's
  /// last step, or the number of the first slot that plays the plan.
  const SlotClock* slots = nullptr;
  std::optional<std::uint64_t> first_slot{};

  std::optional<FirstSlot> first() const {
    return slots ? slots->first(captured_s) : first_slot ? std::optional(FirstSlot{*first_slot, {}}) : std::nullopt;
  }
};

/// The results of a frame besides its plan. Valid until the planner's next step.
struct FrameReport {
  std::uint64_t sequence = 0;
  double time_s = 0;  ///< capture, on the source's clock
  /// Fingers as they were seen. The plan may have fewer voices: match them by id, or with by_finger (voice.hpp).
  const touch::Touch* touch = nullptr;
  std::span<const gpu::PassTime> passes;   ///< in the order they ran, on the device or as C++ twins
  double arrived_s = 0, planned_s = 0;     ///< on the loop's clock: frame in memory, drives in memory
  std::optional<Prediction> prediction{};  ///< of a frame with fingers, if foci are predicted
  Effort effort{};                         ///< of a loop: the work that is done
  bool outdated = false;                   ///< of a loop: its drives were ready only when its hold was over
  std::optional<std::uint32_t> hands = 1;  ///< what the frame shows of hands, for Touches::update
};

class Planner {
 public:
  virtual ~Planner() = default;
  /// Whether another frame can be started before a step.
  virtual bool can_start() const = 0;
  /// Whether frames are in progress.
  virtual bool busy() const = 0;
  /// Starts a frame.
  virtual void start(const SkinFrame& frame) = 0;
  /// Advances the oldest frame in progress by one stage; waits for the device if necessary. True when its plan is
  /// complete.
  virtual bool step(Plan& plan, FrameReport& report) = 0;
  /// Prepares the device for all frames: drivers compile a kernel when it is first dispatched, which takes seconds if
  /// it is not in a cache. Does not change any result. Does nothing after the first frame.
  virtual void warm_up() {}
  /// Sets the effort for frames from the next start on. most_shed() is the maximum that can be shed; by default
  /// nothing.
  virtual void set_effort(const Effort&) {}
  virtual Effort most_shed() const { return {}; }
  /// The warning if plans take too long, where frames are not the reason.
  virtual std::string_view too_slow() const { return {}; }
  /// Whether plans also list the drives of a cycle of foci that stand still, for a link that plays them by its own
  /// clock.
  virtual void list_standing(bool) {}
  /// From the next start on; see touch::Stage::set_pose.
  virtual void set_pose(std::uint32_t solid, const Transform& T_world_rest) = 0;
  /// The id of the next new finger, if fingers are followed.
  virtual std::uint32_t next_id() const { return 0; }
  virtual void number_from(std::uint32_t /*id*/) {}
};

/// `device` computes points and drives; null: the host does. Fingers are the host's in both cases. With a live setting
/// on a device, there are two frames in flight, and a frame that has more skin than there is room for is left out with
/// a warning; otherwise, this is an error. `setting` and `scheduler` must outlive it. Throws Error if the device is
/// lost. The drives of frames with foci that `sounds`, which may be null, knows are computed on the host.
std::unique_ptr<Planner> make_planner(const gpu::Device* device, const SessionSetting& setting, Scheduler& scheduler,
                                      FingerSounds* sounds = nullptr);

/// Reserves the memory that a live frame needs in a touch: any number of fingers and foci, `contacts_per_finger`
/// contacts (a finger with more grows once), and as many deep points as a frame in flight has room for.
inline constexpr std::size_t contacts_per_finger = 4096;
inline constexpr std::uint32_t most_deep = 1U << 18;
void reserve(touch::Touch& touch);

/// The setting of the predictor of a session whose stage has these cameras and solids.
PredictorSetting predictor_setting(const SessionSetting& setting, const Scheduler& scheduler, const CameraView& view,
                                   const touch::PreparedSolids& solids);

/// The setting of the stage. Events, clicks and stiffness, also those that may come, get deep points.
touch::StageSetting stage_setting(const SessionSetting& setting);

}  // namespace palpa::session
