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
  data_.picture = &picture();
  const bool only_with_ctrl = event.key == key_of('z') && !event.ctrl;
  if (const std::string reason = idle_reason(data_, event.key); !reason.empty() && !only_with_ctrl)
    return say(log::Level::info, reason, now_s_);
  switch (event.key) {
    case Key::space:
      return play_or_pause();
    case Key::left:
      data_.asked.step -= 1;
      return;
    case Key::right:
      data_.asked.step += 1;
      return;
    case Key::tab:
      data_.panels = !data_.panels;
      return;
    case Key::escape:
      return close_innermost();
    default:
      break;
  }
  if (!participant_key(event.key)) character_key(event);
}

void App::character_key(const WindowEvent& event) {
  double& slots_per_s = data_.state.time.slots_per_s;
  switch (static_cast<char>(event.key)) {
    case 'h':
      data_.help = !data_.help;
      break;
    case 'o':
      switch_off();
      break;
    case 'r':
      data_.asked.record = true;
      break;
    case 'c':
      (event.ctrl ? data_.asked.copy : data_.asked.copy_picture) = true;
      break;
    case 't':
      data_.asked.frame_touch = true;
      break;
    case ',':
      data_.asked.slots -= 1;
      break;
    case '.':
      data_.asked.slots += 1;
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
  if (!data_.playback) {
    data_.state.time.playing = !data_.state.time.playing;
    return;
  }
  Playback play = data_.asked.play.value_or(*data_.playback);
  play.playing = !play.playing;
  data_.asked.play = play;
}

/// Lists that have dropped down, and what is dragged, have had the key before.
void App::close_innermost() {
  stale_.redraw();
  if (data_.picker) return data_.picker.reset();
  if (opening_.busy()) return cancel_opening();  // data_.opening shows it from the next picture on
  if (data_.help) return void(data_.help = false);
  if (data_.reading) {
    data_.reading.reset();
    data_.state.picked.reset();
    return;
  }
  if (data_.live) return say(log::Level::info, "nothing is open; Q quits", now_s_);
  quitting_ = true;
}

void App::ask_to_quit() {
  const bool again = now_s_ - quit_asked_s_ <= quit_again_s;
  quitting_ = again || !data_.sounding;
  if (quitting_) return;
  quit_asked_s_ = now_s_;
  say(log::Level::warning, "the array sounds: press Q again within 2 s to quit", now_s_);
}

}  // namespace palpa::viewer
