#include "viewer/panel_data/messages.hpp"

#include <algorithm>

namespace palpa::viewer {
namespace {

constexpr double toast_s = 6;
constexpr std::size_t most_toasts = 4;

}  // namespace

void Messages::say(log::Level level, const std::string& line, const std::string& about) {
  changed_ = true;
  if (const auto same = std::ranges::find(toasts_, line, &Toast::text); same != toasts_.end()) {
    same->until_s = now_s_ + toast_s;  // a second reading gives the same warning
    return;
  }
  if (toasts_.size() >= most_toasts) toasts_.pop_front();
  toasts_.push_back({line, level, now_s_ + toast_s, about});
  log_.push_back({level, line});
}

void Messages::settled(const std::string& about) {
  changed_ = std::erase_if(toasts_, [&](const Toast& toast) { return toast.about == about; }) > 0 || changed_;
}

void Messages::advance(double now_s, const std::vector<log::Line>& logged) {
  now_s_ = now_s;
  changed_ = std::erase_if(toasts_, [&](const Toast& toast) { return now_s >= toast.until_s; }) > 0 || changed_;
  for (const log::Line& line : logged) {
    if (line.level <= log::Level::warning) {
      say(line.level, line.text);
    } else {
      log_.push_back(line);
    }
  }
  while (log_.size() > log::Tail::most)
    log_.pop_front();
}

}  // namespace palpa::viewer
