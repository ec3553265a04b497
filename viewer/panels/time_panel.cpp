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
  const std::string name = what;
  moves.play = button(data, playing ? "pause" : "play", (playing ? "Pauses the " : "Plays the ") + name + play_key,
                      true, name + " play", {em(4), 0});
  ImGui::SameLine();
  if (button(data, "< step", std::string("One ") + step + " back" + step_keys, true, name + " back")) moves.step = -1;
  ImGui::SameLine();
  if (button(data, "step >", std::string("One ") + step + " on" + step_keys, true, name + " step")) moves.step = 1;
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
  ImGui::SetNextItemWidth(em(9));
  slider(data, "slots speed", "speed##slots", time.slots_per_s, 1, 0.5f, 667, "%.1f slots/s",
         ImGuiSliderFlags_Logarithmic);
  tip("How fast slots are shown; with a dwell of 1.5 ms, 667 slots/s is the array's own speed. Keys: - and +");
}

void draw_recording(PanelData& data) {
  Playback play = *data.content.run.playback;
  ImGui::Text("Recording, which the run plays");
  tip("The frames that the run gets. While the recording is paused, the array falls silent after the hold");
  const Moves moves = draw_moves(data, "recording", play.playing, ". Key: Space", ". Keys: left and right", "frame");
  if (moves.play) play.playing = !play.playing;
  data.asked.step += moves.step;
  ImGui::SameLine();
  bool changed = check_box(data, "loop", play.loop, "Plays from the beginning again at the end") || moves.play;
  if (!data.content.before.empty()) {
    ImGui::SameLine();
    if (button(data, "close", "Closes the recording: frames come from " + data.content.before + " again", true,
               "close recording"))
      data.asked.options.push_back({"--source", data.content.before});
  }
  int frame = static_cast<int>(play.frame);
  const std::string place = fmt::format("frame %d, {:.2f} of {:.2f} s", play.time_s, play.length_s);
  ImGui::SetNextItemWidth(-1);
  if (slider(data, "recording frame", "##frame", frame, std::max(static_cast<int>(play.frames) - 1, 1), place.c_str()))
    data.asked.go_to = static_cast<std::uint64_t>(std::clamp(frame, 0, static_cast<int>(play.frames) - 1));
  tip("Where the recording is");
  ImGui::SetNextItemWidth(em(9));
  changed = slider(data, "recording speed", "speed##recording", play.speed, 1, 0.05f, 4, "%.2f x",
                   ImGuiSliderFlags_Logarithmic) ||
            changed;
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
