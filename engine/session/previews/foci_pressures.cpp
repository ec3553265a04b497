#include "session/previews/foci_pressures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acoustics/field/pressure.hpp"
#include "array/drive_options.hpp"
#include "session/loop/output.hpp"

namespace palpa::session {
namespace {

/// Below this gain, a modulation is near its trough and says little about its crest.
constexpr double least_modulation = 0.5;

double modulation_of(const array::Schedule& schedule, const array::Voice& voice, std::uint64_t slot) {
  const double midpoint_s = (static_cast<double>(slot) + 0.5) * schedule.slot_s;
  return array::modulation_gain(voice.modulation, voice.modulation_hz, midpoint_s) *
         array::modulate(voice.course, slot, schedule.slot_s);
}

}  // namespace

std::vector<std::vector<double>> foci_pressures(const Plan& plan, const SessionSetting& setting) {
  const array::Schedule& schedule = plan.schedule;
  const bool unmodulated = plan.cycle.is_listed() && (plan.cycle.modulation_hz != 0 || plan.course.changes());
  const std::uint64_t first = array::first_changing_slot(schedule);
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> least;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v)
    least.emplace_back(schedule.voices[v].foci.size(), never);
  const OutputSetting output{.layout = setting.layout, .drive = setting.drive, .slot_s = schedule.slot_s, .safety = {}};
  SlotScratch scratch;
  std::vector<array::SlotFocus> foci;
  for (std::uint64_t slot = first; slot < first + plan.cycle.slots_to_look_at(); ++slot) {
    array::foci_of_slot(schedule, slot, foci);
    const auto drive = plan.cycle.is_listed() ? plan.drive(slot, setting.layout.transducers.size())
                                              : drive_of_slot(plan, slot, plan.captured_s, output, scratch);
    for (const array::SlotFocus& focus : foci) {
      const double part = unmodulated ? 1 : modulation_of(schedule, schedule.voices[focus.voice], slot);
      if (part < least_modulation || !array::drivable(focus)) continue;
      const double pressure = std::abs(acoustics::pressure_at(setting.layout, drive, focus.position,
                                                              setting.drive.medium, setting.drive.directivity));
      double& lowest = least[focus.voice][focus.number];
      lowest = std::min(lowest, pressure / part);
    }
  }
  for (std::vector<double>& voice : least)
    std::ranges::replace(voice, never, 0.0);
  return least;
}

}  // namespace palpa::session
