#include "viewer/app/participant_control.hpp"

#include <utility>

#include "viewer/options/monitors.hpp"

namespace palpa::viewer {

void ParticipantControl::open(const ViewerOptions& options, double now_s) {
  constexpr double leave_line_s = 10;
  close();
  if (!window_->setting) window_->setting = participant_of(options);
  window_->open = true;
  leave_line_until_s_ = now_s + leave_line_s;
  stretched_.clear();
  stale_->redraw();
}

void ParticipantControl::failed(const std::string& fault) {
  close();
  messages_->say(log::Level::error, fault);
}

void ParticipantControl::tell_monitors(std::vector<std::string> names, const std::string& wanted) {
  window_->monitors = std::move(names);
  window_->monitor = chosen_monitor(window_->monitors, wanted);
}

void ParticipantControl::advance(double now_s) {
  window_->says_how_to_leave = window_->open && window_->monitors.size() == 1 && now_s < leave_line_until_s_;
}

void ParticipantControl::fills(const Size& size) {
  if (!window_->open || !window_->setting || size.width == 0 || size.height == 0) return;
  const std::string line = stretched(window_->setting->screen, size.width, size.height);
  if (line != std::exchange(stretched_, line) && !line.empty()) messages_->say(log::Level::warning, line);
}

}  // namespace palpa::viewer
