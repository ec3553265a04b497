// From depth frames to drives: the compute side of the loop, one frame after the other, several in flight.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "acoustics/tune.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "gpu/device.hpp"
#include "gpu/timestamps.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "session/plan.hpp"
#include "touch/method.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// Everything that stays the same for the chain's life. The referenced values outlive it.
struct ChainSetting {
  std::span<const sensing::Camera> cameras;
  const std::vector<geometry::Solid>& solids;
  const array::Layout& layout;  ///< as posed in the world
  touch::Parameters touch;
  touch::MethodOptions method;
  array::VoiceOptions voice;
  bool tune = false;  ///< each finger's stride is chosen by its perimeter, see acoustics::StrideTuner
  array::DriveOptions drive;
  double slot_s = 1.5e-3;  ///< one drive lasts that long
  /// What of a touch the frames' reports hold: contacts cost time and are for those who look at them.
  touch::Detail detail = touch::Detail::fingers;
};

/// What became of a frame besides its plan. Valid until the next call of Chain::step.
struct FrameReport {
  std::uint64_t sequence = 0;
  double time_s = 0;  ///< capture, on the source's clock
  const touch::Touch* touch = nullptr;
  std::span<const gpu::PassTime> passes;  ///< on the device; empty with the C++ twins
  double started_s = 0, planned_s = 0;    ///< on the loop's clock: frame in memory, drives in memory
};

class Chain {
 public:
  virtual ~Chain() = default;
  /// Whether another frame can be started before a step.
  virtual bool can_start() const = 0;
  /// Whether frames are under way.
  virtual bool busy() const = 0;
  /// Takes a frame in; `frame` may be reused at once. `now_s` and `captured_s` are on the loop's clock.
  virtual void start(const sensing::FrameSet& frame, double captured_s, double now_s) = 0;
  /// Brings the oldest frame under way one stage further, waiting for the device where it must. True when its plan is
  /// complete.
  virtual bool step(Plan& plan, FrameReport& report) = 0;
};

/// Passes on the device; two frames in flight. Throws Error where the device is lost; a frame that exceeds its
/// capacity is left out with a warning.
std::unique_ptr<Chain> make_gpu_chain(const gpu::Device& device, const ChainSetting& setting);
/// The same through the passes' C++ twins.
std::unique_ptr<Chain> make_cpu_chain(const ChainSetting& setting);

/// What reserve() gives a frame's deep points: as many as a frame in flight has room for.
inline constexpr std::uint32_t most_deep = 1U << 18;

/// Gives a touch all the room that a live frame needs, so that the loop allocates nothing once it runs: any number of
/// fingers and foci, `contacts_per_finger` contacts (a finger that ever has more grows once).
inline constexpr std::size_t contacts_per_finger = 4096;
void reserve(touch::Touch& touch);

/// How fingers become voices.
struct ScheduleOptions {
  touch::MethodOptions method;  ///< places the foci
  array::VoiceOptions voice;    ///< what a finger's solid asks for takes its place
  bool tune = false;            ///< each finger's stride follows its perimeter, see acoustics::StrideTuner
};

/// What make_schedule keeps from frame to frame.
struct ScheduleMemory {
  touch::Placement placement;
  acoustics::StrideTuner strides;
};
void reserve(ScheduleMemory& memory);

/// Turns the fingers of a frame into the voices of `schedule`.
void make_schedule(const touch::Touch& touch, double time_s, std::span<const geometry::Solid> solids,
                   const ScheduleOptions& options, double slot_s, ScheduleMemory& memory, array::Schedule& schedule);

}  // namespace palpa::session
