#include "session/previews/ear_sound.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "array/layouts/board_play.hpp"
#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/output.hpp"

namespace palpa::session {
namespace {

/// The most periods, times transducers: the computation takes about 0.1 s.
constexpr double most_periods = 1e7;
constexpr double longest_s = 0.1;

/// How many slots are looked at: `cycle` of them repeat without the modulation. 0: none do.
std::size_t slots_of(std::size_t cycle, double modulation_hz, double slot_s, std::size_t most) {
  if (cycle == 0) return most;
  for (std::size_t slots = cycle; slots <= most; slots += cycle) {
    const double turns = static_cast<double>(slots) * slot_s * modulation_hz;
    if (std::abs(turns - std::round(turns)) < 1e-6) return slots;
  }
  return std::max<std::size_t>(most / cycle * cycle, std::min(most, cycle));
}

}  // namespace

EarDrives ear_drives(const Plan& plan, const SessionSetting& setting, bool steps) {
  EarDrives out;
  const array::Layout& layout = setting.layout;
  out.transducers = layout.transducers.size();
  out.slot_s = plan.schedule.slot_s;
  if (plan.schedule.voice_count == 0 || out.transducers == 0) return out;
  const array::Medium& medium = setting.drive.medium;
  out.ear.air = acoustics::air_of({}, medium.frequency, medium.sound_speed);
  out.ear.source_level_pa_m = layout.source_level_pa_m;
  const array::BoardType* const type = array::board_type_of(layout);
  const bool has_clock = type != nullptr && type->modulation_slot_s != nullptr;
  if (has_clock && plan.cycle.modulation_hz != 0 && plan.cycle.length == 1)
    out.slot_s = type->modulation_slot_s(plan.cycle.modulation_hz);
  out.changes = array::changes_of(type, {.slot_s = out.slot_s,
                                         .boards_of_bus = layout.boards.size(),
                                         .steps = steps,
                                         .nulls = setting.drive.nulls != nullptr});

  const double heard_s = std::min(out.slot_s, acoustics::longest_change_s);
  const double of_a_slot = static_cast<double>(out.transducers) * heard_s * medium.frequency;
  const auto most = static_cast<std::size_t>(std::max(1.0, std::min(most_periods / of_a_slot, longest_s / heard_s)));
  const bool repeats = plan.cycle.is_listed() && !plan.course.changes();
  const std::size_t slots = slots_of(repeats ? plan.cycle.length : 0, plan.cycle.modulation_hz, out.slot_s, most);
  const OutputSetting output{.layout = layout, .drive = setting.drive, .slot_s = out.slot_s, .safety = setting.safety};
  const double ceiling = ceiling_of(setting.safety);
  std::optional<array::BoardPlay> boards;
  if (!layout.boards.empty()) boards.emplace(layout);
  SlotScratch scratch;
  array::Drive one;
  const std::uint64_t first = array::first_changing_slot(plan.schedule);
  for (std::uint64_t slot = first; slot < first + slots; ++slot) {
    const auto drive = drive_of_slot(plan, slot, plan.captured_s, output, scratch);
    one.assign(drive.begin(), drive.end());
    for (array::TransducerDrive& transducer : one)
      transducer.amplitude *= static_cast<float>(ceiling);
    if (boards) boards->round(one, ceiling);
    out.drives.insert(out.drives.end(), one.begin(), one.end());
  }
  return out;
}

}  // namespace palpa::session
