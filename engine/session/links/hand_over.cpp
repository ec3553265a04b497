#include "session/links/hand_over.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/log.hpp"
#include "base/text.hpp"

namespace palpa::session {
namespace {

std::uint64_t less(std::uint64_t from, std::uint64_t what) {
  return from - std::min(from, what);
}

/// Where most of them were lost, and what helps.
std::string remedy_of(const HandOver& counts) {
  const Carried& behind = *counts.behind;
  if (!behind.guard) return "end other programs, or give a longer --dwell";
  const std::uint64_t in_guard = less(behind.guard->drives, behind.submitted.drives + behind.starting);
  const std::uint64_t on_wire = less(behind.submitted.drives, behind.completed.drives);
  if (less(counts.loop.drives, behind.guard->drives) >= std::max(in_guard, on_wire)) {
    const bool real_time = behind.guard_scheduling == Scheduling::real_time;
    return fmt::format(
        "palpa-guard got no processor in time; end other programs, {}switch power saving off (cpupower "
        "frequency-set -g performance), or give a longer --dwell",
        real_time ? "" : "give it real-time scheduling (palpa doctor says how), ");
  }
  if (in_guard >= on_wire) return "the board took no more; give a longer --dwell, or foci that stand still";
  return "the device did not take what was sent; put it on a USB controller of its own, without a hub, or give a "
         "longer --dwell";
}

/// The device was not there.
const char* remedy_of_stuck(const HandOver& counts) {
  return counts.behind->guard
             ? "for a time, the device took none; see whether it is plugged in and switched on, and its server runs"
             : "for a time, nobody took any; see whether the receiver runs";
}

}  // namespace

std::uint64_t HandOver::lost() const {
  return behind ? less(loop.drives, behind->completed.drives + behind->starting) : 0;
}

std::string to_text(const HandOver& counts) {
  const std::string all = counted(counts.loop.drives, "drive") + " sounded";
  if (!counts.behind) return all + "; the link does not report how many it played";
  const Carried& behind = *counts.behind;
  if (!behind.guard) return all + fmt::format(", {} were played", behind.completed.drives);
  const std::string starting =
      behind.starting > 0 ? fmt::format(", {} came before the first plan of a touch", behind.starting) : "";
  return all + fmt::format(": {} were taken by the guard, {} were submitted to the board, {} were completed{}",
                           behind.guard->drives, behind.submitted.drives, behind.completed.drives, starting);
}

void HandOverWatch::look(const HandOver& counts, bool last) {
  if (!counts.behind || warned_) return;
  const std::uint64_t completed = counts.behind->completed.drives;
  const std::uint64_t more = less(counts.lost(), std::exchange(lost_, counts.lost()));
  const bool arrived = completed != std::exchange(completed_, completed);
  const bool stuck = more > 0 && (!arrived || counts.behind->out_of_reach);
  stuck_ += stuck ? more + newest_ : 0;
  newest_ = stuck ? 0 : more;
  if (!counts.unusual() || (!stuck && !last && more > 0)) return;
  warned_ = true;
  const bool mostly_stuck = 2 * stuck_ > counts.lost();
  log::warning(fmt::format("{} of {} drives were lost between loop and device; at most {} are normal ({}): {}",
                           counts.lost(), counts.loop.drives, counts.normal(), to_text(counts),
                           mostly_stuck ? remedy_of_stuck(counts) : remedy_of(counts)));
}

}  // namespace palpa::session
