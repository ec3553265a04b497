#include "study/sitting/heard_level.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/board_play.hpp"
#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "array/schedule.hpp"
#include "geometry/haptics.hpp"

namespace palpa::study {
namespace {

constexpr double ring_radius_m = 17.5e-3;

/// A voice whose foci lie around the middle of the objects' tops.
array::Voice voice_of(const PlanMethod& method, std::span<const Box> objects, double dwell_s) {
  Vec3 middle(0);
  for (const Box& box : objects)
    middle += Vec3(box.centre().x, box.high.y, box.centre().z) / static_cast<double>(objects.size());
  array::Voice voice;
  voice.dwell_s = dwell_s;
  const bool still = touch::stands_still(method.method), together = touch::sounds_together(method.method);
  const std::uint32_t count = still && !together ? 1 : method.foci;
  const std::uint32_t stride = method.stride.value_or(geometry::default_stride(method.foci));
  voice.foci_per_slot = together ? count : 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    voice.foci.push_back(count == 1 ? middle : middle + ring_radius_m * Vec3(std::cos(angle), 0, std::sin(angle)));
    voice.order.push_back(together ? i : i * stride % count);
  }
  if (still) voice.modulation_hz = method.modulation_hz;
  return voice;
}

acoustics::EarLevel level_of(const PlanMethod& method, const StudyPlan& plan, std::span<const Box> objects,
                             const array::Layout& layout) {
  const array::BoardType* const type = array::board_type_of(layout);
  const bool still = touch::stands_still(method.method);
  double slot_s = method.dwell_s;
  if (still && type != nullptr && type->modulation_slot_s != nullptr)
    slot_s = type->modulation_slot_s(method.modulation_hz);
  array::Schedule schedule;
  schedule.slot_s = slot_s;
  schedule.add_voice() = voice_of(method, objects, slot_s);
  const auto cycle = static_cast<double>(still ? 1 : schedule.voices[0].order.size());
  double slots = cycle;
  const double most = 0.1 / std::min(slot_s, acoustics::longest_change_s);
  for (double more = cycle; still && more <= most; more += cycle) {
    slots = more;
    const double turns = more * slot_s * method.modulation_hz;
    if (std::abs(turns - std::round(turns)) < 1e-6) break;
  }
  acoustics::EarOptions ear;
  ear.air = acoustics::air_of({}, layout.frequency_hz);
  ear.source_level_pa_m = layout.source_level_pa_m;
  Vec3 centre(0);
  for (const array::Transducer& transducer : layout.transducers)
    centre += transducer.position / static_cast<double>(layout.transducers.size());
  ear.distance_m =
      std::max(0.1, std::min(glm::distance(centre, plan.level.ears[0]), glm::distance(centre, plan.level.ears[1])));
  const array::DriveOptions options{.weighting = method.amplitude.value_or(layout.amplitude_law),
                                    .constraint = method.constraint.value_or(array::Constraint::uniform),
                                    .medium = ear.air.medium,
                                    .solver = method.solver.value_or(array::Solver::gs_pat)};
  const array::BoardPlay boards(layout);
  array::Drive drives;
  std::vector<array::SlotFocus> foci;
  for (std::uint64_t slot = 0; slot < static_cast<std::uint64_t>(slots); ++slot) {
    array::foci_of_slot(schedule, slot, foci);
    array::Drive drive = array::drive_for(layout, foci, options);
    for (array::TransducerDrive& one : drive)
      one.amplitude *= static_cast<float>(plan.level.ceiling);
    boards.round(drive, plan.level.ceiling);
    drives.insert(drives.end(), drive.begin(), drive.end());
  }
  const array::Changes changes = array::changes_of(type, {.slot_s = slot_s, .boards_of_bus = layout.boards.size()});
  return acoustics::ear_level({drives, layout.transducers.size(), slot_s, changes}, ear);
}

}  // namespace

acoustics::EarLevel predict_heard_level(const StudyPlan& plan, std::span<const Box> objects,
                                        const array::Layout* placed) {
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  acoustics::EarLevel loudest{nothing, nothing};
  for (const PlanMethod& method : plan.methods) {
    const array::Layout own = array::load_layout(method.layout);
    const array::Layout layout = placed ? *placed : array::transformed(own, own.default_T_world_layout);
    const acoustics::EarLevel level = level_of(method, plan, objects, layout);
    if (level.high_dba > loudest.high_dba) loudest = level;
  }
  return loudest;
}

}  // namespace palpa::study
