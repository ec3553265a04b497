#include "fakes.hpp"
#include "array/drive.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace palpa::test {

array::Layout small_layout() {
  array::Layout layout;
  layout.name = "small";
  for (int i = 0; i < 16; ++i)
    layout.transducers.push_back({Vec3(0.01 * i, 0, 0), Vec3(0, 1, 0)});
  return layout;
}

std::vector<geometry::Solid> solids_with(const std::vector<geometry::Haptics>& haptics) {
  std::vector<geometry::Solid> solids(haptics.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    solids[s].name = "solid " + std::to_string(s);
    solids[s].haptics = haptics[s];
  }
  return solids;
}

void list_drives(const array::Layout& layout, session::Plan& plan) {
  session::SlotWork work;
  session::plan_slots(plan, work, nullptr, [&](std::span<const array::SlotFocus> slot_foci, const auto&) {
    plan.drives.resize(plan.drives.size() + layout.transducers.size());
    array::drive_for(layout, slot_foci, {}, std::span(plan.drives).last(layout.transducers.size()));
  });
}

array::Schedule touching(const Vec3& centre, double modulation_hz) {
  array::Schedule schedule;
  array::Voice& voice = schedule.add_voice();
  voice.foci.clear();
  for (int i = 0; i < 10; ++i) {
    const double angle = 0.628318 * i;
    voice.foci.push_back(centre + Vec3(0.004 * std::cos(angle), 0, 0.004 * std::sin(angle)));
  }
  voice.order = array::fill_order(10, 3);
  voice.modulation_hz = modulation_hz;
  return schedule;
}

bool FakeSource::next(sensing::FrameSet& out, double) {
  if (given == count) return false;
  if (before) before(given);
  clock->sleep_until(clock->now() + period_s);
  out.frames.resize(1);
  out.frames[0].depth.assign(4, 500);
  out.sequence = given;
  const double now_s = clock->now();
  if (given == 0) begin_s = now_s;
  out.time_s = (given < reset_at ? 100.0 : 1.0) + (now_s - begin_s) * clock_rate;
  ++given;
  return true;
}

void FakePlanner::start(const session::SkinFrame& frame) {
  captured_s = frame.captured_s;
  current = {frame.sequence, frame.time_s, &touch, {}, frame.arrived_s, 0};
  under_way = true;
}

bool FakePlanner::step(session::Plan& plan, session::FrameReport& report) {
  if (before) before(current.sequence);
  seen.push_back(current.sequence);
  touch.finger_count = fingers(current.sequence);
  plan.schedule = touch.finger_count ? touching(Vec3(0, 0.15, 0)) : array::Schedule();
  plan.captured_s = captured_s;
  plan.drives.clear();
  list_drives(layout, plan);
  report = current;
  under_way = false;
  return true;
}

float loudest_of(std::span<const array::TransducerDrive> drive) {
  float loud = 0;
  for (const array::TransducerDrive& transducer : drive)
    loud = std::max(loud, transducer.amplitude);
  return loud;
}

void SpyLink::plan(const session::PlayedPlan& plan) {
  const bool touched = plan.schedule.voice_count > 0;
  plans.push_back({plan.schedule.voice_count, plan.slots, touched ? plan.schedule.voices[0].gain : 0,
                   loudest_of(plan.drives), &plan.schedule, plan.drives.data()});
}

void SpyLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  const float loud = loudest_of(drive);
  most = std::max(most.load(), loud);
  sent.push_back(drive.data());
  if (slots.size() >= fail_at && (broken || slots.size() == fail_at)) {
    slots.push_back(slot);
    loudest.push_back(broken ? loud : -1.0f);
    throw failure("spy: the link broke");
  }
  slots.push_back(slot);
  loudest.push_back(loud);
}

}  // namespace palpa::test
