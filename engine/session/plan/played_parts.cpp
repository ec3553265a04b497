#include "session/plan/played_parts.hpp"

#include <cmath>
#include <complex>

#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"

namespace palpa::session {

const array::Schedule& PlayedParts::correct(const Plan& plan) {
  schedule_ = plan.schedule;
  const double ceiling = ceiling_of(safety_);
  if (!plan.cycle.is_listed() || plan.cycle.length == 0 || !(ceiling > 0)) return schedule_;
  const std::uint64_t slot = calls_++ % plan.cycle.length;
  const std::span<const array::TransducerDrive> drive = plan.drive(slot, layout_.transducers.size());
  drive_.assign(drive.begin(), drive.end());
  for (array::TransducerDrive& one : drive_)
    one.amplitude *= static_cast<float>(ceiling);
  boards_.round(drive_, ceiling, array::Round::down);
  array::foci_of_slot(schedule_, slot, foci_);
  for (const array::SlotFocus& focus : foci_) {
    array::Voice& voice = schedule_.voices[focus.voice];
    if (!voice.reached_pa || !array::drivable(focus)) continue;
    const auto heard = [&](std::span<const array::TransducerDrive> sound) {
      return std::abs(acoustics::pressure_at(layout_, sound, focus.position, medium_, directivity_));
    };
    // Not between the crests of a modulation, where the sound is that of other foci.
    const double asked_pa = heard(drive);
    if (asked_pa > 0 && asked_pa >= 0.5 * *voice.reached_pa) *voice.reached_pa *= heard(drive_) / (asked_pa * ceiling);
  }
  return schedule_;
}

}  // namespace palpa::session
