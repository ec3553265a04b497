// Keys, and how the viewer closes.
#include <algorithm>

#include "viewer/app/app.hpp"
#include "viewer/panels/key_sheet.hpp"

namespace palpa::viewer {
namespace {

constexpr double quit_again_s = 2;  ///< while the array sounds, a second press within this time quits

}  // namespace

void App::handle_key(const WindowEvent& event) {
  stale_.redraw();
  desk_.picture = &picture();
  const bool only_with_ctrl = event.key == key_of('z') && !event.ctrl;
  if (const std::string reason = idle_reason(desk_, event.key); !reason.empty() && !only_with_ctrl)
    return say(log::Level::info, reason, now_s_);
  switch (event.key) {
    case Key::space:
      return play_or_pause();
    case Key::left:
      desk_.asked.step -= 1;
      return;
    case Key::right:
      desk_.asked.step += 1;
      return;
    case Key::tab:
      desk_.panels = !desk_.panels;
      return;
    case Key::escape:
      return close_innermost();
    default:
      break;
  }
  if (!participant_key(event.key)) character_key(event);
}

void App::character_key(const WindowEvent& event) {
  double& slots_per_s = desk_.state.time.slots_per_s;
  switch (static_cast<char>(event.key)) {
    case 'h':
      desk_.help = !desk_.help;
      break;
    case 'o':
      switch_off();
      break;
    case 'r':
      desk_.asked.record = true;
      break;
    case 'c':
      (event.ctrl ? desk_.asked.copy : desk_.asked.copy_picture) = true;
      break;
    case 't':
      desk_.asked.frame_touch = true;
      break;
    case ',':
      desk_.asked.slots -= 1;
      break;
    case '.':
      desk_.asked.slots += 1;
      break;
    case '-':
      slots_per_s = std::max(slots_per_s / 2, 0.5);
      break;
    case '+':
    case '=':
      slots_per_s = std::min(slots_per_s * 2, 667.0);
      break;
    default:
      break;
  }
}

/// The recording if there is one, else the slots.
void App::play_or_pause() {
  if (!desk_.playback) {
    desk_.state.time.playing = !desk_.state.time.playing;
    return;
  }
  Playback play = desk_.asked.play.value_or(*desk_.playback);
  play.playing = !play.playing;
  desk_.asked.play = play;
}

/// Lists that have dropped down, and what is dragged, have had the key before.
void App::close_innermost() {
  stale_.redraw();
  if (desk_.picker) return desk_.picker.reset();
  if (opening_.busy()) return cancel_opening();  // desk_.opening shows it from the next picture on
  if (desk_.help) return void(desk_.help = false);
  if (desk_.reading) {
    desk_.reading.reset();
    desk_.state.picked.reset();
    return;
  }
  if (desk_.live) return say(log::Level::info, "nothing is open; Q quits", now_s_);
  quitting_ = true;
}

void App::ask_to_quit() {
  const bool again = now_s_ - quit_asked_s_ <= quit_again_s;
  quitting_ = again || !desk_.sounding;
  if (quitting_) return;
  quit_asked_s_ = now_s_;
  say(log::Level::warning, "the array sounds: press Q again within 2 s to quit", now_s_);
}

}  // namespace palpa::viewer
