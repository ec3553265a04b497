#include "session/output.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <exception>

namespace palpa::session {
namespace {

std::span<const array::TransducerDrive> silence(const OutputSetting& setting, array::Drive& scratch) {
  scratch.assign(setting.layout.transducers.size(), {0.0f, 0.0f});
  return scratch;
}

bool expired(const Plan& plan, double now_s, const OutputSetting& setting) {
  return plan.schedule.voice_count == 0 || now_s >= plan.captured_s + setting.hold_s;
}

/// Runs `work`; the first error of all is kept, later ones are consequences.
template <typename Work>
void keep_error(std::exception_ptr& first, Work work) {
  try {
    work();
  } catch (...) {
    if (!first) first = std::current_exception();
  }
}

}  // namespace

void SlotScratch::reserve(std::size_t transducers) {
  constexpr std::size_t most_foci = std::size_t{touch::max_fingers} * touch::max_foci;
  drive.reserve(transducers);
  foci.reserve(most_foci);
  work.sources.reserve(most_foci);
  work.sums.reserve(transducers);
}

std::span<const array::TransducerDrive> drive_of_slot(const Plan& plan, std::uint64_t slot, double now_s,
                                                      const OutputSetting& setting, SlotScratch& scratch) {
  if (expired(plan, now_s, setting)) return silence(setting, scratch.drive);
  const std::size_t transducers = setting.layout.transducers.size();
  if (plan.cycle == 0) {
    scratch.drive.resize(transducers);
    array::foci_of_slot(plan.schedule, slot, scratch.foci);
    array::drive_for(setting.layout, scratch.foci, setting.drive, scratch.drive, scratch.work);
    return scratch.drive;
  }
  const auto drive = plan.drive(slot, transducers);
  if (plan.shared_modulation_hz == 0) return drive;
  scratch.drive.assign(drive.begin(), drive.end());
  const double midpoint_s = (static_cast<double>(slot) + 0.5) * setting.slot_s;
  const auto gain =
      static_cast<float>(array::modulation_gain(plan.shared_modulation, plan.shared_modulation_hz, midpoint_s));
  for (array::TransducerDrive& transducer : scratch.drive)
    transducer.amplitude *= gain;
  return scratch.drive;
}

void play(Link& link, Newest<Plan>& plans, const OutputSetting& setting, const Clock& clock,
          const std::atomic<bool>& stop, OutputStats& stats) {
  // The kernel may delay a sleeping thread by 50 microseconds to save power; a slot is 1500.
  prctl(PR_SET_TIMERSLACK, 1000);
  SlotScratch scratch;
  scratch.reserve(setting.layout.transducers.size());
  array::Schedule nothing;
  std::uint64_t slot = 0;
  std::exception_ptr fault;
  keep_error(fault, [&] {
    const double begin_s = clock.now();
    bool sounding = false;
    while (!stop) {
      const double due_s = begin_s + static_cast<double>(slot) * setting.slot_s;
      clock.sleep_until(due_s);
      const double now_s = clock.now();
      const bool fresh = plans.take();
      const Plan& plan = plans.front();
      const bool silent = expired(plan, now_s, setting);
      nothing.time_s = plan.schedule.time_s;
      if (fresh) {
        link.foci(silent ? nothing : plan.schedule);
        stats.first_drive(now_s - plan.captured_s);
      } else if (silent && sounding) {
        link.foci(nothing);  // frames stopped coming: whoever listens to foci must hear of the end, too
      }
      sounding = !silent;
      link.send(slot, drive_of_slot(plan, slot, now_s, setting, scratch));
      stats.sent(now_s - due_s, silent);
      // Overslept by a whole slot or more: the slots between are over.
      const auto running = static_cast<std::uint64_t>(std::floor((clock.now() - begin_s) / setting.slot_s));
      if (running > slot + 1) stats.skipped(running - slot - 1);
      slot = std::max(slot + 1, running);
    }
  });
  // Whatever happened: no sound remains.
  keep_error(fault, [&] { link.foci(nothing); });
  keep_error(fault, [&] { link.send(slot, silence(setting, scratch.drive)); });
  keep_error(fault, [&] { link.finish(); });
  if (fault) std::rethrow_exception(fault);
}

}  // namespace palpa::session
