// What the output thread plays: the drives of one frame's schedule.
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
/// A schedule repeats after its cycle, so the drives of that many slots are all there is to know; a modulation that all
/// fingers share is left to the output as one gain per slot. Where the cycle is too_long the output computes each
/// slot's drive itself.
struct Plan {
  array::Schedule schedule;
  double captured_s = 0;   ///< on the loop's clock
  double more_hold_s = 0;  ///< how much longer than the usual hold it may sound after that
  Cycle cycle;
  std::vector<array::TransducerDrive> drives;  ///< cycle.length * transducers

  /// Of a plan whose cycle is listed.
  std::span<const array::TransducerDrive> drive(std::uint64_t slot, std::size_t transducers) const {
    return std::span(drives).subspan((slot % cycle.length) * transducers, transducers);
  }
};

/// The plan as a link gets it, for the slots from `from` up to but not including `until`.
PlayedPlan played(const Plan& plan, std::size_t transducers, std::uint64_t from, std::uint64_t until);

/// Makes it a plan that has nothing to drive, before its slots are planned.
void list_nothing(Plan& plan);

/// Gives these values all the room that a live frame needs, so that the loop allocates nothing once it runs: any number
/// of fingers and foci, most_cycle drives.
void reserve(Plan& plan, std::size_t transducers);
void reserve(array::Schedule& schedule);

/// Where the slots of plans are worked out; keeps its storage.
struct SlotWork {
  array::Schedule unmodulated;
  std::vector<array::SlotFocus> foci;
};

/// Fills cycle and pressures; returns the schedule whose slots are to be planned.
const array::Schedule& begin_slots(Plan& plan, SlotWork& work, array::Loudness* loudness);

/// Which slots a plan for its schedule must hold: fills its cycle, and gives the foci of each of its slots, without the
/// modulation where that is shared. `add` is called once per slot, in order, with the foci and,
/// where fingers ask for a pressure and `loudness` is there, their factors, else none. Fills what pressures the voices
/// reach then.
template <typename Add>
void plan_slots(Plan& plan, SlotWork& work, array::Loudness* loudness, Add add) {
  const bool asked = loudness != nullptr && array::Loudness::asked(plan.schedule);
  const array::Schedule& planned = begin_slots(plan, work, asked ? loudness : nullptr);
  for (std::uint32_t slot = 0; slot < plan.cycle.length; ++slot) {
    array::foci_of_slot(planned, slot, work.foci);
    add(work.foci, asked ? loudness->factors(slot) : std::span<const std::complex<double>>());
  }
}

/// Fills a plan's drives on the host. `loudness`, of this layout and these options, is needed where fingers may ask for
/// a pressure.
void drive_on_host(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, SlotWork& work,
                   array::Loudness* loudness, array::DriveScratch& scratch);

}  // namespace palpa::session
