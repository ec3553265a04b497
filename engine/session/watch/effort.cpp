#include "session/watch/effort.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/log.hpp"

namespace palpa::session {
namespace {

/// Factor by which a hold is made longer than necessary, so that the next frame need not change it.
constexpr double spare = 1.1;

}  // namespace

bool EffortControl::planned(const FrameTimes& frame) {
  shed_frames_ += now_.whole() ? 0 : 1;
  if (++steady_ <= settle && acted()) return false;
  const double reach_s = frame.capture_to_plan_s + std::min(frame.apart_s, frame.work_s);
  late_ = reach_s > most_of_hold * hold_s_ ? late_ + 1 : 0;
  calm_ = reach_s <= calm_below * default_hold_s_ ? calm_ + 1 : 0;
  const double without_s = frame.capture_to_plan_s + (2 * more_without_last_step() - 1) * frame.work_s;
  sure_ = without_s <= sure_below * default_hold_s_ ? sure_ + 1 : 0;
  if (late_ >= late_frames) return shed(reach_s);
  return (sure_ >= first_calm || calm_ >= calm_needed_) && take_back();
}

bool EffortControl::shed(double reach_s) {
  late_ = 0;
  if (exhausted()) return false;
  if (!acted()) late_s_ = reach_s;
  if (now_ == most_) {
    hold_s_ = std::min(reach_s / most_of_hold * spare, longest_hold_s_);
    most_hold_s_ = std::max(most_hold_s_, hold_s_);
    steady_ = calm_ = sure_ = 0;
    return true;
  }
  // The step that was taken back is needed, so taking it back is tried less often from now on.
  if (taken_back_) calm_needed_ = std::min(2 * calm_needed_, longest_calm);
  taken_back_ = false;
  now_.pixel_stride < most_.pixel_stride ? ++now_.pixel_stride : ++now_.foci_part;
  least_ = {std::max(least_.pixel_stride, now_.pixel_stride), std::max(least_.foci_part, now_.foci_part)};
  steady_ = calm_ = sure_ = 0;
  return true;
}

bool EffortControl::take_back() {
  calm_ = sure_ = 0;
  if (hold_s_ > default_hold_s_) {
    hold_s_ = default_hold_s_;
    steady_ = late_ = 0;
    return true;
  }
  if (now_.whole()) return false;
  taken_back_ = true;
  now_.foci_part > 1 ? --now_.foci_part : --now_.pixel_stride;
  steady_ = late_ = 0;
  return true;
}

/// Factor by which a frame may take longer without the last step, if that step affects all of its work.
double EffortControl::more_without_last_step() const {
  if (hold_s_ > default_hold_s_) return 1;
  const auto more = [](std::uint32_t n) { return n > 1 ? static_cast<double>(n) / (n - 1) : 1.0; };
  if (now_.foci_part > 1) return more(now_.foci_part);
  return more(now_.pixel_stride) * more(now_.pixel_stride);
}

std::string to_text(const Effort& effort) {
  constexpr const char* nth[] = {"", "", "2nd", "3rd", "4th"};
  std::string text;
  if (effort.pixel_stride > 1)
    text = fmt::format("only every {0} pixel of every {0} row was used", nth[effort.pixel_stride]);
  if (effort.foci_part > 1) {
    text += fmt::format("{}fingers had one in {} of their foci", text.empty() ? "" : " and ", effort.foci_part);
  }
  return text.empty() ? "nothing was left out" : text;
}

void ShedReport::planned(const EffortControl& control) {
  if (control.acted() && control.steady() >= a_while) tell(control);
}

void ShedReport::end(const EffortControl& control) {
  if (control.acted()) tell(control);
}

void ShedReport::tell(const EffortControl& control) {
  if (std::exchange(told_, true)) return;
  std::string what = to_text(control.least());
  if (control.most_hold_s() > hold_s_)
    what += fmt::format(", and a frame sounded for up to {:.0f} ms", 1e3 * control.most_hold_s());
  log::warning(fmt::format(
      "overloaded: from the capture of a frame to the drives of the next one it took {:.0f} ms, more than {:.0f} % of "
      "the hold of {:.0f} ms, so {}; use fewer or smaller solids, a smaller roi or a longer --hold, or end other "
      "programs",
      1e3 * control.late_s(), 100 * EffortControl::most_of_hold, 1e3 * hold_s_, what));
}

}  // namespace palpa::session
