// The plan that the output thread plays: the drives of one frame's schedule.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "array/loudness.hpp"
#include "array/schedule.hpp"
#include "session/links/link.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

/// The schedule of one frame, solved for a layout.
///
/// A schedule repeats after its cycle, so the drives of one cycle are sufficient. If all fingers share a modulation,
/// the output applies it as one gain per slot. If the cycle is too_long, the output computes each slot's drive itself.
struct Plan {
  array::Schedule schedule;
  double captured_s = 0;   ///< on the loop's clock
  double more_hold_s = 0;  ///< extra time beyond the usual hold that it may sound after captured_s
  Cycle cycle;
  std::vector<array::TransducerDrive> drives;  ///< cycle.length * transducers

  /// Only for a plan whose cycle is listed.
  std::span<const array::TransducerDrive> drive(std::uint64_t slot, std::size_t transducers) const {
    return std::span(drives).subspan((slot % cycle.length) * transducers, transducers);
  }
};

/// The plan in the form that a link gets, for the slots from `from` up to but not including `until`.
PlayedPlan played(const Plan& plan, std::size_t transducers, std::uint64_t from, std::uint64_t until);

/// Resets it to a plan that has nothing to drive, before its slots are planned.
void list_nothing(Plan& plan);

/// Reserves the memory that a live frame can need, for any number of fingers and foci and most_cycle drives. The
/// running loop then allocates nothing.
void reserve(Plan& plan, std::size_t transducers);
void reserve(array::Schedule& schedule);

/// Scratch memory for planning slots; keeps its storage.
struct SlotWork {
  array::Schedule unmodulated;
  std::vector<array::SlotFocus> foci;
};

/// Fills cycle and pressures; returns the schedule whose slots are to be planned.
const array::Schedule& begin_slots(Plan& plan, SlotWork& work, array::Loudness* loudness);

/// Determines the slots that a plan for its schedule must hold. Fills its cycle and finds the foci of each of its
/// slots, without a shared modulation. `add` is called once per slot, in order, with the foci and their factors. There
/// are factors only if fingers request a pressure and `loudness` is given. In that case, the pressures that the voices
/// reach are filled in.
template <typename Add>
void plan_slots(Plan& plan, SlotWork& work, array::Loudness* loudness, Add add) {
  const bool asked = loudness != nullptr && array::Loudness::asked(plan.schedule);
  const array::Schedule& planned = begin_slots(plan, work, asked ? loudness : nullptr);
  for (std::uint32_t slot = 0; slot < plan.cycle.length; ++slot) {
    array::foci_of_slot(planned, slot, work.foci);
    add(work.foci, asked ? loudness->factors(slot) : std::span<const std::complex<double>>());
  }
}

/// Fills a plan's drives on the host. `loudness`, made for this layout and these options, is needed if fingers may
/// request a pressure.
void drive_on_host(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, SlotWork& work,
                   array::Loudness* loudness, array::DriveScratch& scratch);

}  // namespace palpa::session
