// What the participant sees, and which object.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "viewer/app/app.hpp"
#include "viewer/app/own_files.hpp"
#include "viewer/options/monitor.hpp"

namespace palpa::viewer {
namespace {

constexpr double leave_line_s = 10;

}  // namespace

/// The rig's screen is read only when it is needed, because a rig may have none.
void App::open_participant(bool open) {
  PanelData::ParticipantWindowState& view = data_.participant;
  view.open = false;
  if (!open) return;
  if (!view.setting) {
    ViewerOptions options = options_;
    if (const std::string& rig = data_.edit.options().rig.rig; !rig.empty()) options.input.rig = rig;
    view.setting = participant_of(options);
  }
  view.open = true;
  leave_line_until_s_ = now_s_ + leave_line_s;
  stretched_.clear();
  stale_.redraw();
}

/// On a single monitor, the participant's window covers the other, so it says how to leave it.
void App::advance_participant(double now_s) {
  PanelData::ParticipantWindowState& view = data_.participant;
  view.says_how_to_leave = view.open && view.monitors.size() == 1 && now_s < leave_line_until_s_;
}

void App::participant_fills(const Size& size) {
  const PanelData::ParticipantWindowState& view = data_.participant;
  if (!view.open || !view.setting || size.width == 0 || size.height == 0) return;
  const std::string line = stretched(view.setting->screen, size.width, size.height);
  if (line != std::exchange(stretched_, line) && !line.empty()) say(log::Level::warning, line, now_s_);
}

void App::try_participant(bool open) {
  try {
    open_participant(open);
  } catch (const Error& error) {
    say(log::Level::error, error.what(), now_s_);
  }
}

void App::tell_monitors(std::vector<std::string> names) {
  PanelData::ParticipantWindowState& view = data_.participant;
  view.monitors = std::move(names);
  view.monitor = chosen_monitor(view.monitors, options_.monitor);
}

void App::participant_window_failed(const std::string& fault) {
  data_.participant.open = false;
  say(log::Level::error, fault, now_s_);
}

void App::handle_participant(const WindowEvent& event) {
  if (event.kind != WindowEvent::Kind::key || !event.down || event.repeat) return;
  stale_.redraw();
  if (event.key == Key::escape) return try_participant(false);
  if (event.key == key_of('o')) return switch_off();
  participant_key(event.key);
}

/// Handles the keys that both windows take.
bool App::participant_key(Key key) {
  if (key == key_of('v')) {
    data_.participant.hidden = !data_.participant.hidden;
  } else if (key == key_of('p')) {
    data_.asked.participant = !data_.participant.open;
  } else if (key == key_of('q')) {
    ask_to_quit();
  } else if (key == Key::page_up || key == Key::page_down) {
    switch_object(key == Key::page_down ? 1 : -1);
  } else {
    return false;
  }
  stale_.redraw();
  return true;
}

/// Opens the next or previous scene of its folder, by name.
void App::switch_object(int by) {
  const std::string& now = data_.edit.options().scene;
  if (now.empty()) return;
  const std::vector<std::string> scenes = scenes_beside(now);
  const auto here = std::ranges::find_if(scenes, [&](const std::string& scene) {
    return std::filesystem::path(scene).filename() == std::filesystem::path(now).filename();
  });
  if (here == scenes.end() || scenes.size() < 2)
    return say(log::Level::warning, now + ": its folder has no other object to switch to", now_s_);
  const auto count = static_cast<std::ptrdiff_t>(scenes.size());
  const std::ptrdiff_t next = (here - scenes.begin() + by + count) % count;
  open(scenes[static_cast<std::size_t>(next)], now_s_);
}

}  // namespace palpa::viewer
