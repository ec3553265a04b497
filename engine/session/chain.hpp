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

/// What the output thread plays: the drives of one frame's schedule.
///
/// A schedule repeats after `cycle` slots, so the drives of slots 0..cycle-1 are all there is to know; a modulation
/// that all fingers share is left to the output as one gain per slot. A schedule that does not repeat within most_cycle
/// slots (odd dwells with several modulations) has cycle 0: the output then computes each slot's drive itself.
struct Plan {
  array::Schedule schedule;
  double captured_s = 0;  ///< on the loop's clock
  std::uint32_t cycle = 0;
  double shared_modulation_hz = 0;  ///< 0: none, or not shared
  array::Modulation shared_modulation = array::Modulation::pressure_sine;
  std::vector<array::TransducerDrive> drives;  ///< cycle * transducers

  std::span<const array::TransducerDrive> drive(std::uint64_t slot, std::size_t transducers) const {
    return std::span(drives).subspan((slot % cycle) * transducers, transducers);
  }
};
inline constexpr std::uint32_t most_cycle = 128;

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

/// What reserve() gives a frame's deep points: as many as a frame in flight has room for (touch::capacity_for).
inline constexpr std::uint32_t most_deep = 1U << 18;

/// Gives these values all the room that a live frame needs, so that the loop allocates nothing once it runs: any number
/// of fingers and foci, most_cycle drives, `contacts_per_finger` contacts (a finger that ever has more grows once).
inline constexpr std::size_t contacts_per_finger = 4096;
void reserve(Plan& plan, std::size_t transducers);
void reserve(array::Schedule& schedule);
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

/// Which slots a plan for `schedule` must hold: fills cycle and shared modulation of the plan, and the foci of each of
/// its slots, gains being 1 where the modulation is shared. `add` is called once per slot, in order.
template <typename Add>
void plan_slots(Plan& plan, array::Schedule& unmodulated, std::vector<array::SlotFocus>& foci, Add add) {
  const array::Schedule& schedule = plan.schedule;
  const bool shared = array::shared_modulation(schedule);
  plan.shared_modulation_hz = shared && schedule.voice_count > 0 ? schedule.voices[0].modulation_hz : 0.0;
  if (plan.shared_modulation_hz != 0) plan.shared_modulation = schedule.voices[0].modulation;
  const array::Schedule* planned = &schedule;
  if (plan.shared_modulation_hz != 0) {
    unmodulated = schedule;
    for (std::uint32_t v = 0; v < unmodulated.voice_count; ++v)
      unmodulated.voices[v].modulation_hz = 0;
    planned = &unmodulated;
  }
  plan.cycle = schedule.voice_count == 0 ? 0 : static_cast<std::uint32_t>(array::cycle_length(*planned, most_cycle));
  for (std::uint32_t slot = 0; slot < plan.cycle; ++slot) {
    array::foci_of_slot(*planned, slot, foci);
    add(foci);
  }
}

}  // namespace palpa::session
