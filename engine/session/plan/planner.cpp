#include "session/plan/planner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "session/plan/scheduler.hpp"

namespace palpa::session {
namespace {

/// Depth frames that are processed one by one may show a whole hand in a solid, with more contacts than a frame of a
/// loop has.
constexpr std::uint32_t most_contacts_of_one = 1U << 20;

}  // namespace

void reserve(touch::Touch& touch) {
  touch.contacts.reserve(touch::max_fingers * contacts_per_finger);
  touch.deep.reserve(most_deep);
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

PredictorSetting predictor_setting(const SessionSetting& setting, const Scheduler& scheduler, const CameraView& view,
                                   const touch::PreparedSolids& solids) {
  const array::Voice voice = scheduler.common_voice();
  const std::size_t steps = voice.order.size() / voice.foci_per_slot;
  const double cycle = std::round(static_cast<double>(steps) * voice.dwell_s / scheduler.slot_s());
  return {.options = setting.predict,
          .view = view,
          .solids = solids,
          .parameters = setting.touch,
          .cycle = static_cast<std::uint32_t>(std::clamp(cycle, 1.0, 1e3)),
          .slot_s = scheduler.slot_s()};
}

std::vector<sensing::Slab> slabs_of(const array::Layout& layout) {
  std::vector<sensing::Slab> slabs;
  for (const array::Board& board : layout.boards)
    slabs.push_back({sensing::NoSkin::board, board.width_m, board.height_m, board.T_layout_board});
  return slabs;
}

sensing::Surroundings surroundings_of(const SessionSetting& setting) {
  sensing::Surroundings all = setting.surroundings;
  if (setting.keep_boards) return all;
  const std::vector<sensing::Slab> boards = slabs_of(setting.layout);
  all.slabs.insert(all.slabs.begin(), boards.begin(), boards.end());
  return all;
}

bool drops_points(const SessionSetting& setting) {
  const bool learned =
      std::ranges::any_of(setting.cameras, [](const auto& camera) { return camera.background != nullptr; });
  return !setting.cameras.empty() && (learned || !surroundings_of(setting).empty());
}

FingerDrives::FingerDrives(const SessionSetting& setting, const Scheduler& scheduler, FingerSounds& sounds)
    : layout_(setting.layout), sounds_(sounds), in_free_air_(setting.drive), drive_(setting.drive) {
  drive_.transfer = &sounds;
  if (scheduler.needs_pressures()) loudness_.emplace(layout_, drive_);
  array::reserve(scratch_, layout_, drive_, touch::max_fingers);
}

bool FingerDrives::make(Plan& plan) {
  if (!sounds_.take(plan.schedule)) return false;
  const std::size_t transducers = layout_.transducers.size();
  plan.drives.clear();
  plan_slots(plan, work_, loudness_ ? &*loudness_ : nullptr, [&](const auto& foci, const auto& factors) {
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
  constexpr float pi = 3.1415925F;  // the largest float that is not above it
  for (std::size_t t = 0; t < out.size(); ++t) {
    float phase = out[t].phase - aimed->phases[t];
    phase += phase > pi ? -2 * std::numbers::pi_v<float> : phase < -pi ? 2 * std::numbers::pi_v<float> : 0.0F;
    out[t].phase = std::clamp(phase, -pi, pi);
  }
}

touch::StageSetting stage_setting(const SessionSetting& setting) {
  touch::StageSetting stage{.parameters = setting.touch,
                            .follow = setting.follow,
                            .axes = setting.axes,
                            .smoothing = setting.smoothing,
                            .hysteresis = setting.hysteresis,
                            .memory_s = setting.hold_s};
  if (!setting.cameras.empty()) stage.surroundings = surroundings_of(setting);
  stage.most_contacts = setting.live() || setting.cameras.empty() ? 0 : most_contacts_of_one;
  if (setting.events) stage.parameters.deep = true;
  return stage;
}

}  // namespace palpa::session
