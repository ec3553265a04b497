#include "viewer/app/keys.hpp"

#include <algorithm>
#include <string_view>

namespace palpa::viewer {
namespace {

/// The recording if there is one, else the slots.
void play_or_pause(PanelData& data) {
  if (!data.content.run.playback) {
    data.state.time.playing = !data.state.time.playing;
    return;
  }
  Playback play = data.asked.play.value_or(*data.content.run.playback);
  play.playing = !play.playing;
  data.asked.play = play;
}

}  // namespace

bool goes_on(const WindowEvent& event) {
  constexpr std::string_view characters = ",.-+=z";
  return event.key == Key::left || event.key == Key::right ||
         characters.find(character_of(event.key)) != std::string_view::npos;
}

bool ask_by_key(const WindowEvent& event, PanelData& data) {
  double& slots_per_s = data.state.time.slots_per_s;
  switch (character_of(event.key)) {
    case character_of(Key::space):
      play_or_pause(data);
      break;
    case character_of(Key::left):
      data.asked.step -= 1;
      break;
    case character_of(Key::right):
      data.asked.step += 1;
      break;
    case character_of(Key::tab):
      data.panels = !data.panels;
      break;
    case 'h':
      data.help = !data.help;
      break;
    case 'r':
      data.asked.record = true;
      break;
    case 'c':
      (event.ctrl ? data.asked.copy : data.asked.copy_picture) = true;
      break;
    case 't':
      data.asked.frame_touch = true;
      break;
    case ',':
      data.asked.slots -= 1;
      break;
    case '.':
      data.asked.slots += 1;
      break;
    case '-':
      slots_per_s = std::max(slots_per_s / 2, 0.5);
      break;
    case '+':
    case '=':
      slots_per_s = std::max(slots_per_s, std::min(slots_per_s * 2, 667.0));
      break;
    default:
      return false;
  }
  return true;
}

}  // namespace palpa::viewer
