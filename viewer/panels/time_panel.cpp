// What plays: the slots of the schedule, and a recording. Both have the same words: play, pause, step, loop, speed.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <string>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

/// "play" or "pause", and a step back and on. Returns what was asked for.
struct Moves {
  bool play = false;
  int step = 0;
};
Moves draw_moves(PanelData& data, const char* what, bool playing, const std::string& play_key,
                 const std::string& step_keys, const char* step) {
  Moves moves;
  ImGui::PushID(what);
  const float width = em(4);
  if (ImGui::Button(playing ? "pause" : "play", {width, 0})) moves.play = true;
  data.places.named[std::string(what) + " play"] = last_area();
  tip(std::string(playing ? "Pauses" : "Plays") + " the " + what + play_key);
  ImGui::SameLine();
  if (ImGui::Button("< step")) moves.step = -1;
  tip(std::string("One ") + step + " back" + step_keys);
  ImGui::SameLine();
  if (ImGui::Button("step >")) moves.step = 1;
  data.places.named[std::string(what) + " step"] = last_area();
  tip(std::string("One ") + step + " on" + step_keys);
  ImGui::PopID();
  return moves;
}

void draw_slots(PanelData& data) {
  SlotTime& time = data.state.time;
  ImGui::Text("Slots, in the picture only");
  tip("The schedule, slowed down until you can see it. The array keeps its own time");
  ImGui::SameLine();
  ImGui::Text("  slot %llu", static_cast<unsigned long long>(time.slot));
  const Moves moves = draw_moves(data, "slots", time.playing, data.content.run.playback ? "" : ". Key: Space",
                                 ". Keys: , and .", "slot");
  if (moves.play) time.playing = !time.playing;
  data.asked.slots += moves.step;
  auto rate = static_cast<float>(time.slots_per_s);
  ImGui::SetNextItemWidth(em(9));
  if (ImGui::SliderFloat("speed##slots", &rate, 0.5f, 667, "%.1f slots/s",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput))
    time.slots_per_s = std::clamp(rate, 0.5f, 667.0f);
  tip("How fast slots are shown; with a dwell of 1.5 ms, 667 slots/s is the array's own speed. Keys: - and +");
}

void draw_recording(PanelData& data) {
  Playback play = *data.content.run.playback;
  bool changed = false;
  ImGui::Text("Recording, which the run plays");
  tip("The frames that the run gets. While the recording is paused, the array falls silent after the hold");
  const Moves moves = draw_moves(data, "recording", play.playing, ". Key: Space", ". Keys: left and right", "frame");
  if (moves.play) {
    play.playing = !play.playing;
    changed = true;
  }
  data.asked.step += moves.step;
  ImGui::SameLine();
  changed = ImGui::Checkbox("loop", &play.loop) || changed;
  data.places.named["loop"] = last_area();
  tip("Plays from the beginning again at the end");
  if (!data.content.before.empty()) {
    ImGui::SameLine();
    if (ImGui::Button("close")) data.asked.options.push_back({"--source", data.content.before});
    data.places.named["close recording"] = last_area();
    tip("Closes the recording: frames come from " + data.content.before + " again");
  }
  int frame = static_cast<int>(play.frame);
  const std::string place = fmt::format("frame %d, {:.2f} of {:.2f} s", play.time_s, play.length_s);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##frame", &frame, 0, std::max(static_cast<int>(play.frames) - 1, 1), place.c_str(),
                       ImGuiSliderFlags_NoInput))
    data.asked.go_to = static_cast<std::uint64_t>(std::clamp(frame, 0, static_cast<int>(play.frames) - 1));
  tip("Where the recording is");
  auto speed = static_cast<float>(play.speed);
  ImGui::SetNextItemWidth(em(9));
  if (ImGui::SliderFloat("speed##recording", &speed, 0.05f, 4, "%.2f x",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput)) {
    play.speed = std::clamp(speed, 0.05f, 4.0f);
    changed = true;
  }
  tip("How fast the recording plays; 1 x is as it was recorded");
  if (changed) data.asked.play = play;
}

}  // namespace

void draw_time_panel(PanelData& data) {
  if (data.content.run.playback) {
    draw_recording(data);
    ImGui::Separator();
  }
  draw_slots(data);
}

}  // namespace palpa::viewer
