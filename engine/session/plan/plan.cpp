#include "session/plan/plan.hpp"

#include <algorithm>

#include "touch/types.hpp"

namespace palpa::session {

namespace {

/// Decides which drives a plan lists whose foci advance.
void list_advance(Plan& plan, bool lists_standing) {
  array::Advance& advance = plan.schedule.advance;
  advance.cycle = plan.cycle.is_listed() ? plan.cycle.length : most_cycle;
  advance.cycles = std::max(2U, (least_advance_slots + advance.cycle - 1) / advance.cycle);
  if (!plan.cycle.is_listed()) return;
  plan.standing = lists_standing ? plan.cycle.length : 0;
  if (plan.standing + advance.listed() <= most_cycle) return;
  advance = {};
  plan.standing = 0;
}

std::size_t foci_together(const array::Schedule& schedule) {
  std::size_t foci = 0;
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v)
    foci += schedule.voices[v].foci_per_slot;
  return foci;
}

}  // namespace

void reserve(Plan& plan, std::size_t transducers) {
  array::reserve(plan.schedule, touch::max_fingers, touch::max_foci);
  plan.drives.reserve(most_cycle * transducers);
  plan.foci.reserve(most_cycle);
}

void reserve(SlotWork& work) {
  array::reserve(work.unmodulated, touch::max_fingers, touch::max_foci);
  work.foci.reserve(std::size_t{touch::max_fingers} * touch::max_foci);
}

array::Schedule& begin_slots(Plan& plan, SlotWork& work) {
  array::Schedule& schedule = plan.schedule;
  Cycle& cycle = plan.cycle;
  const bool silent = schedule.voice_count == 0;
  const bool asked = array::Loudness::asked(schedule);
  const bool one_gain = !silent && array::shared_modulation(schedule);
  cycle.modulation_hz = one_gain ? schedule.voices[0].modulation_hz : 0.0;
  plan.course = one_gain ? schedule.voices[0].course : array::Course();
  if (cycle.modulation_hz != 0) cycle.modulation = schedule.voices[0].modulation;
  plan.standing = 0;
  if (silent || asked) schedule.advance = {};
  array::Schedule* planned = &schedule;
  if (cycle.modulation_hz != 0 || plan.course.changes()) {
    work.unmodulated = schedule;
    for (std::uint32_t v = 0; v < work.unmodulated.voice_count; ++v) {
      work.unmodulated.voices[v].modulation_hz = 0;
      work.unmodulated.voices[v].course = {};
    }
    planned = &work.unmodulated;
  }
  cycle.length = silent ? 0 : static_cast<std::uint32_t>(array::cycle_length(*planned, most_cycle));
  work.first_listed = 0;
  if (!silent && cycle.length == 0 && !asked && foci_together(schedule) > work.most_unlisted_foci) {
    cycle.length = work.unrepeated;
    work.first_listed = std::max(array::first_changing_slot(*planned), work.first_slot);
  }
  cycle.plays = silent ? Plays::nothing : cycle.length > 0 ? Plays::pattern : Plays::slot_by_slot;
  if (schedule.advance.moves()) {
    list_advance(plan, work.lists_standing);
    planned->advance = schedule.advance;
  }
  return *planned;
}

void solve_pressures(Plan& plan, array::Schedule& planned, SlotWork& work, array::Loudness& loudness) {
  array::Schedule& schedule = plan.schedule;
  // If slots do not repeat soon enough, they are solved when they play. The first most_cycle slots, with the full gains
  // of all voices, determine their loudness.
  array::Schedule* loudest = &planned;
  if (array::changes(planned)) {
    work.unmodulated = schedule;
    for (std::uint32_t v = 0; v < work.unmodulated.voice_count; ++v)
      work.unmodulated.voices[v].course = {};
    loudest = &work.unmodulated;
  }
  loudness.solve(*loudest, plan.cycle.slots_to_look_at());
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    schedule.voices[v].target_pa = loudest->voices[v].target_pa;
    schedule.voices[v].reached_pa = loudest->voices[v].reached_pa;
  }
}

void drive_on_host(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, SlotWork& work,
                   array::Loudness* loudness, array::SlotDrives& slots) {
  const std::size_t transducers = layout.transducers.size();
  slots.clear();
  plan_slots(plan, work, loudness, [&](const auto& foci, const auto& factors) { slots.add(foci, factors); });
  plan.drives.resize(slots.size() * transducers);
  slots.solve(layout, options, plan.drives);
}

void drive_by_own(Plan& plan, const array::Layout& layout, const array::DriveOptions& options, const OwnSolver& solver,
                  SlotWork& work) {
  const std::size_t transducers = layout.transducers.size();
  work.most_unlisted_foci = 0;
  work.unrepeated = most_cycle;
  plan.drives.clear();
  plan_slots(plan, work, nullptr, [&](const auto& foci, const auto&) {
    plan.drives.resize(plan.drives.size() + transducers, {0.0F, 0.0F});
    if (!foci.empty()) solver(layout, options, foci, std::span(plan.drives).last(transducers));
  });
}

PlayedPlan played(const Plan& plan, std::size_t transducers, std::uint64_t from, std::uint64_t until) {
  if ((plan.schedule.advance.moves() && plan.standing == 0) || array::changes(plan.schedule)) {
    Cycle unlisted = plan.cycle;
    unlisted.plays = Plays::slot_by_slot;
    unlisted.length = 0;
    return {.schedule = plan.schedule, .slots = {from, until, unlisted}};
  }
  return {.schedule = plan.schedule,
          .slots = {from, until, plan.cycle},
          .drives = std::span(plan.drives).first(plan.cycle.length * transducers),
          .foci = plan.foci};
}

void list_nothing(Plan& plan) {
  plan.cycle.plays = Plays::nothing;
  plan.cycle.length = 0;
  plan.foci.clear();
  plan.course = {};
  plan.standing = 0;
}

}  // namespace palpa::session
