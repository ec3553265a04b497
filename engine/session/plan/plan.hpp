// The plan that the output thread plays: the drives of one frame's schedule.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/loudness.hpp"
#include "array/schedule.hpp"
#include "array/slot_drives.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "session/links/link.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

/// The schedule of one frame, solved for a layout.
///
/// A schedule repeats after its cycle, so the drives of one cycle are sufficient. If all fingers share a modulation and
/// a course, the output applies both as one gain per slot. If it plays slot_by_slot, the output computes each slot's
/// drive itself, which must be quick.
///
/// If its foci advance, a plan lists more: the drives of all slots that differ (array::Advance), and before them, for a
/// link that plays plans by its own clock, one cycle of foci that stand where they are in the middle of the first
/// cycle.
struct Plan {
  array::Schedule schedule;
  double captured_s = 0;   ///< on the loop's clock
  double more_hold_s = 0;  ///< extra time beyond the usual hold that it may sound after captured_s
  Cycle cycle;
  array::Course course;        ///< of all fingers, if they share one: the listed drives do not include it
  std::uint32_t standing = 0;  ///< the drives of the cycle of standing foci, if foci advance: cycle.length or 0
  std::vector<array::TransducerDrive> drives;  ///< listed() * transducers
  std::vector<Vec3> foci;  ///< of the first cycle.length drives, if each is that of one focus; else empty

  /// The number of drives.
  std::uint32_t listed() const {
    return cycle.is_listed() && schedule.advance.moves() ? standing + schedule.advance.listed() : cycle.length;
  }
  /// Only for a plan whose cycle is listed.
  std::span<const array::TransducerDrive> drive(std::uint64_t slot, std::size_t transducers) const {
    const std::uint64_t number =
        schedule.advance.moves() ? standing + schedule.advance.number_of(slot) : slot % cycle.length;
    return std::span(drives).subspan(number * transducers, transducers);
  }
};

/// The plan in the form that a link gets, for the slots from `from` up to but not including `until`. Foci that advance
/// are where they are in the middle of the first cycle; their drives are listed only for a link that plays them. Drives
/// are not listed if gains change from slot to slot, because they do not repeat.
PlayedPlan played(const Plan& plan, std::size_t transducers, std::uint64_t from, std::uint64_t until);

/// Resets it to a plan that has nothing to drive, before its slots are planned.
void list_nothing(Plan& plan);

/// Reserves the memory that a live frame can need, for any number of fingers and foci and most_cycle drives. The
/// running loop then allocates nothing.
void reserve(Plan& plan, std::size_t transducers);

/// A frame of a camera with 90 Hz lasts 7.4 slots.
inline constexpr std::uint32_t least_unrepeated_slots = 20;

/// Rules and scratch memory for planning slots; keeps its storage.
struct SlotWork {
  bool lists_standing = false;  ///< the link plays plans by its own clock
  /// If a schedule does not repeat soon enough, and more foci than this sound together, the output would not be quick.
  /// The plan then lists the first `unrepeated` slots that play it, which repeat. Not if foci request a pressure.
  std::size_t most_unlisted_foci = std::numeric_limits<std::size_t>::max();
  std::uint32_t unrepeated = least_unrepeated_slots;
  std::uint64_t first_slot = 0;  ///< that plays the plan, if it is known

  std::uint64_t first_listed = 0;  ///< begin_slots: the drives are those of this slot and the following ones
  array::Schedule unmodulated;
  std::vector<array::SlotFocus> foci;
};

/// Reserves the memory that planning a live frame can need.
void reserve(SlotWork& work);

/// Fills cycle and advance; returns the schedule whose slots are to be planned. Foci that advance stand still if they
/// request a pressure, because its factors belong to the places of all foci, or if there are too many drives to list.
array::Schedule& begin_slots(Plan& plan, SlotWork& work);

/// Solves the slots for the requested pressures, and fills in those that the voices reach. `planned`: of begin_slots.
void solve_pressures(Plan& plan, array::Schedule& planned, SlotWork& work, array::Loudness& loudness);

/// Foci that advance have at least two cycles, and as many as there are in this many slots.
inline constexpr std::uint32_t least_advance_slots = 20;

/// Determines the slots that a plan for its schedule must hold. Fills its cycle and finds the foci of each of its
/// slots, without a shared modulation. `add` is called once per slot, in order, with the foci and their factors. There
/// are factors only if fingers request a pressure and `loudness` is given. In that case, the pressures that the voices
/// reach are filled in.
template <typename Add>
void plan_slots(Plan& plan, SlotWork& work, array::Loudness* loudness, Add add) {
  array::Schedule& planned = begin_slots(plan, work);
  const bool asked = loudness != nullptr && array::Loudness::asked(plan.schedule);
  if (asked) solve_pressures(plan, planned, work, *loudness);
  const array::Advance advance = planned.advance;
  const auto add_slot = [&](std::uint64_t slot, std::uint32_t number) {
    array::foci_of_slot(planned, slot, work.foci);
    add(work.foci, asked ? loudness->factors(number) : std::span<const std::complex<double>>());
  };
  const auto add_cycle = [&](std::uint32_t length) {
    for (std::uint32_t number = 0; number < length; ++number) {
      const std::uint64_t turned = length - work.first_listed % length;
      add_slot(work.first_listed + (number + turned) % length, number);
      if (work.foci.size() == 1) plan.foci.push_back(work.foci[0].position);
    }
    if (plan.foci.size() < length) plan.foci.clear();
  };
  plan.foci.clear();
  if (!plan.cycle.is_listed()) return;
  if (!advance.moves()) {
    add_cycle(plan.cycle.length);
    return;
  }
  planned.advance = {};
  add_cycle(plan.standing);
  planned.advance = advance;
  for (std::uint32_t number = 0; number < advance.listed(); ++number)
    add_slot(advance.first_slot + number, number);
}

/// Fills a plan's drives on the host. `loudness`, made for this layout and these options, is needed if fingers may
/// request a pressure.
void drive_on_host(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, SlotWork& work,
                   array::Loudness* loudness, array::SlotDrives& slots);

/// A solver of the caller's: fills the drive of each transducer of the layout for foci that sound together. There is at
/// least one focus. Amplitudes are 0 to 1. It is called on the thread that computes, and must not throw.
using OwnSolver = std::function<void(const array::Layout& layout, const array::DriveOptions& options,
                                     std::span<const array::SlotFocus> foci, std::span<array::TransducerDrive> out)>;

/// Fills a plan's drives by this solver. The plan lists all of them, because the output must not wait for the solver.
/// Fingers of the schedule request no pressure.
void drive_by_own(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, const OwnSolver& solver,
                  SlotWork& work);

}  // namespace palpa::session
