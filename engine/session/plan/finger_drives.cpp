#include "session/plan/finger_drives.hpp"

#include <numbers>

#include "array/free_drives.hpp"
#include "touch/types.hpp"

namespace palpa::session {

FingerDrives::FingerDrives(const SessionSetting& setting, const Scheduler& scheduler, FingerSounds& sounds)
    : layout_(setting.layout), sounds_(sounds), in_free_air_(setting.drive), drive_(setting.drive) {
  drive_.transfer = &sounds;
  if (scheduler.needs_pressures()) loudness_.emplace(layout_, drive_);
  array::reserve(scratch_, layout_, drive_, touch::max_fingers);
}

bool FingerDrives::make(Plan& plan, SlotWork& work) {
  static const array::Schedule nothing;
  begin_slots(plan, work);
  if (!sounds_.take(plan.cycle.is_listed() ? plan.schedule : nothing)) return false;
  const std::size_t transducers = layout_.transducers.size();
  plan.drives.clear();
  plan_slots(plan, work, loudness_ ? &*loudness_ : nullptr, [&](const auto& foci, const auto& factors) {
    plan.drives.resize(plan.drives.size() + transducers);
    const std::span<array::TransducerDrive> out = std::span(plan.drives).last(transducers);
    if (!factors.empty()) {
      array::drive_by_factors(layout_, foci, factors, drive_, out, scratch_);
    } else if (foci.size() == 1) {
      drive_one(foci[0], out);
    } else {
      array::drive_for(layout_, foci, drive_, out, scratch_);
    }
  });
  return true;
}

/// What drive_for does with the transfer of the sounds, but at the cost of a focus in free air.
void FingerDrives::drive_one(const array::SlotFocus& focus, std::span<array::TransducerDrive> out) {
  const std::optional<FingerSounds::Aimed> aimed = sounds_.aimed(focus.position);
  array::SlotFocus there = focus;
  if (aimed) there.position = aimed->place;
  array::drive_for(layout_, {&there, 1}, in_free_air_, out, scratch_);
  if (!aimed) return;
  constexpr float pi = std::numbers::pi_v<float>;
  for (std::size_t t = 0; t < out.size(); ++t) {
    float phase = out[t].phase - aimed->phases[t];
    phase += phase > pi ? -2 * pi : phase < -pi ? 2 * pi : 0.0F;
    out[t].phase = array::as_phase(phase);
  }
}

}  // namespace palpa::session
