#include "session/loop/output.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/system/real_time.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/real_time_service.hpp"
#include "touch/types.hpp"

namespace palpa::session {
namespace {

std::span<const array::TransducerDrive> silence(const OutputSetting& setting, array::Drive& scratch) {
  scratch.assign(setting.layout.transducers.size(), {0.0f, 0.0f});
  return scratch;
}

/// A plan whose time is not a number has expired: it never sounds.
bool expired(const Plan& plan, double now_s, const OutputSetting& setting) {
  return plan.schedule.voice_count == 0 || !(now_s < plan.captured_s + setting.hold_s + plan.more_hold_s);
}

/// Extra time for the ramp down at the end, because its slots may be late.
constexpr double most_late_s = 0.1;

/// While waiting for a slot, how often to check whether the sound must end earlier.
constexpr double most_sleep_s = 10e-3;

/// How often the output checks how many of its drives have reached the device.
constexpr double look_every_s = 1;

/// The first slot that begins after the plan has expired. Slot 0 began at `begin_s`.
std::uint64_t expiry_slot(const Plan& plan, double begin_s, const OutputSetting& setting) {
  constexpr double most = 1e18;  // a hold without an end
  const double slot = std::ceil((plan.captured_s + setting.hold_s + plan.more_hold_s - begin_s) / setting.slot_s);
  return static_cast<std::uint64_t>(std::clamp(slot, 0.0, most));
}

}  // namespace

void SlotScratch::reserve(const OutputSetting& setting) {
  constexpr std::size_t most_foci = std::size_t{touch::max_fingers} * touch::max_foci;
  drive.reserve(setting.layout.transducers.size());
  foci.reserve(most_foci);
  array::reserve(work, setting.layout, setting.drive, most_foci);
}

std::span<const array::TransducerDrive> drive_of_slot(const Plan& plan, std::uint64_t slot, double now_s,
                                                      const OutputSetting& setting, SlotScratch& scratch) {
  if (expired(plan, now_s, setting)) return silence(setting, scratch.drive);
  const std::size_t transducers = setting.layout.transducers.size();
  if (!plan.cycle.is_listed()) {
    scratch.drive.resize(transducers);
    array::foci_of_slot(plan.schedule, slot, scratch.foci);
    array::drive_for(setting.layout, scratch.foci, setting.drive, scratch.drive, scratch.work);
    return scratch.drive;
  }
  const auto drive = plan.drive(slot, transducers);
  if (plan.cycle.modulation_hz == 0 && !plan.course.changes()) return drive;
  scratch.drive.assign(drive.begin(), drive.end());
  const double midpoint_s = (static_cast<double>(slot) + 0.5) * setting.slot_s;
  const double modulation = array::modulation_gain(plan.cycle.modulation, plan.cycle.modulation_hz, midpoint_s);
  const auto gain = static_cast<float>(modulation * array::modulate(plan.course, slot, setting.slot_s));
  for (array::TransducerDrive& transducer : scratch.drive)
    transducer.amplitude *= gain;
  return scratch.drive;
}

void play(Link& link, Newest<Plan>& plans, const OutputSetting& setting, const Clock& clock, const Ending& ending,
          OutputStats& stats, RunObserver& observer) {
  // The kernel may delay a sleeping thread by 50 microseconds to save power; a slot is 1500.
  prctl(PR_SET_TIMERSLACK, 1000);
  std::optional<KeptInMemory> kept;
  std::optional<RealTime> turns;
  if (clock.is_real()) {
    if (link.plays()) kept.emplace();
    turns.emplace(output_priority, real_time_service());
  }
  const std::size_t transducers = setting.layout.transducers.size();
  SafeLink safe(
      link, transducers, setting.safety, setting.slot_s,
      [&](bool sounds, const HandOver& counts) { observer.sent(sounds, counts); }, setting.drive);
  SlotScratch scratch;
  scratch.reserve(setting);
  array::Schedule nothing;
  nothing.slot_s = setting.slot_s;
  std::uint64_t slot = 0;
  const double begin_s = clock.now();
  if (setting.slots) setting.slots->begin(begin_s);
  bool sounding = false;
  HandOverWatch watch;
  double look_s = begin_s + look_every_s;
  double fade_end_s = std::numeric_limits<double>::infinity();  // set when the end is requested
  const auto too_long = [&](double now_s) {
    if (ending.asked()) return ending.failed || now_s >= fade_end_s || std::isinf(fade_end_s);
    return sounding && expired(plans.front(), now_s, setting);
  };
  const auto must_go_on = [&] {
    if (!ending.asked()) return true;
    return safe.must_fade() && !ending.failed && clock.now() < fade_end_s;
  };
  while (must_go_on()) {
    const double due_s = begin_s + static_cast<double>(slot) * setting.slot_s;
    for (double now_s = clock.now(); now_s < due_s && !too_long(now_s); now_s = clock.now())
      clock.sleep_until(std::min(due_s, now_s + most_sleep_s));
    if (!must_go_on()) break;
    const bool stopped = ending.asked();
    if (stopped && std::isinf(fade_end_s)) fade_end_s = clock.now() + setting.safety.ramp_s + most_late_s;
    const double now_s = clock.now();
    const bool fresh = plans.take();
    const Plan& plan = plans.front();
    const bool silent = stopped || expired(plan, now_s, setting);
    if (fresh) stats.first_drive(now_s - plan.captured_s);
    if (fresh && !silent) {
      safe.plan(played(plan, transducers, slot, expiry_slot(plan, begin_s, setting)));
    } else if (fresh || (silent && sounding)) {
      // Nothing is touched, or frames stopped coming. A link that plays or shows a plan must also learn of its end.
      nothing.time_s = plan.schedule.time_s;
      safe.plan({.schedule = nothing, .slots = {slot, slot}});
    }
    sounding = !silent;
    if (silent) {
      safe.send(slot, silence(setting, scratch.drive));
    } else {
      safe.send_planned(slot, drive_of_slot(plan, slot, now_s, setting, scratch));
    }
    stats.sent(std::max(now_s - due_s, 0.0), !safe.sounded());
    // Late by a whole slot or more: the slots in between are over.
    const auto running = static_cast<std::uint64_t>(std::floor((clock.now() - begin_s) / setting.slot_s));
    if (running > slot + 1) stats.skipped(running - slot - 1);
    slot = std::max(slot + 1, running);
    if (now_s >= look_s) {
      watch.look(safe.handed_over());
      look_s = now_s + look_every_s;
    }
  }
  safe.finish();
  if (turns) stats.scheduling = scheduling_of(0);
  stats.hand_over = safe.handed_over();
  watch.end(stats.hand_over);
}

}  // namespace palpa::session
