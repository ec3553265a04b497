#include "viewer/panels/panels.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/text.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

/// What is done to everything, above the headings.
void draw_tools(Desk& desk) {
  if (ImGui::Button("Open")) desk.picker = picker_to_open(desk.recent);
  desk.places.named["open"] = last_area();
  tip("Opens a glTF model, a PLY or a recording. You can also drop it into the window");
  ImGui::SameLine();
  const bool recording = !desk.recording.empty();
  ImGui::BeginDisabled(!desk.live || desk.live_state != LiveState::running);
  if (ImGui::Button(recording ? "Stop recording" : "Record")) desk.asked.record = true;
  desk.places.named["record"] = last_area();
  ImGui::EndDisabled();
  tip("Records what the cameras see into a new folder while the run continues, with any source. Key: R");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  drop_down("##copy", "Copy", [&] {
    if (ImGui::Selectable("this picture, as palpa-viewer ...")) desk.asked.copy_picture = true;
    if (ImGui::Selectable("this run, as palpa run ...")) desk.asked.copy = true;
  });
  desk.places.named["copy"] = last_area();
  tip("A command line that draws this picture, or that does this run without a window. Key: C, and Ctrl C for the run");
  if (recording) {
    ImGui::Text("%s: %s", desk.recording.c_str(), counted(desk.recorded, "frame").c_str());
    tip("The folder that is being written, and how many frames it has");
  }
  if (!recording && !desk.made.empty()) {
    if (ImGui::Button(("Play " + desk.made).c_str())) desk.asked.open = desk.made;
    desk.places.named["play made"] = last_area();
    tip("The run gets its frames from this recording. Space plays and pauses it, left and right step it");
  }
  if (!desk.doing.empty() && !desk.opening) ImGui::TextWrapped("%s", desk.doing.c_str());
}

void draw_headings(Desk& desk) {
  const bool touched = !desk.picture->fingers.empty();
  if (heading(desk, "Run", false, "What runs: the options of palpa run")) draw_options_panel(desk);
  if (desk.live &&
      heading(desk, "Place", !desk.placed.things.empty(), "How deep fingers are; solids and finger moved by hand"))
    draw_place_panel(desk);
  if (heading(desk, "Time", desk.live || touched, "Slots of the schedule, frames of a recording"))
    draw_time_panel(desk);
  if (heading(desk, "View", !desk.live, "What is drawn, and from where")) draw_view_panel(desk);
  if (!desk.participant.monitors.empty() &&
      heading(desk, "Participant", false, "What the participant sees, in a window of its own"))
    draw_participant_panel(desk);
  if (desk.live && heading(desk, "Statistics", true, "How long frames take, and how many there are"))
    draw_statistics_panel(desk);
  const bool sounds = desk.live || (!desk.picture->transducers.empty() && touched);
  if (sounds && heading(desk, "Sound", false, "The array's sound and its effect on the finger")) draw_sound_panel(desk);
  desk.wants_spectrum = sounds && heading(desk, "Spectrum", false, "What skin feels in time");
  if (desk.wants_spectrum) draw_spectrum_panel(desk);
  if (heading(desk, "Log", false, "Messages of palpa, newest last")) draw_log_panel(desk);
}

}  // namespace

double panels_width(double width, double line_height) {
  return std::round(std::min(20.5 * line_height, 0.45 * width));
}

void draw_panels(Desk& desk, double now_s) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  desk.places = {};
  draw_marks(desk.marks, free_area(desk));
  desk.wants_spectrum = desk.wants_spectrum && desk.panels;
  if (desk.panels) {
    const auto width = static_cast<float>(panels_width(whole.x, em(1)));
    const auto top = static_cast<float>(strip_height(em(1)));
    ImGui::SetNextWindowPos({whole.x, top}, ImGuiCond_Always, {1, 0});
    ImGui::SetNextWindowSize({width, std::max(whole.y - top, 1.0f)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("palpa", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    draw_tools(desk);
    ImGui::BeginChild("below");  // everything above stays in sight
    draw_headings(desk);
    ImGui::TextDisabled("H: keys and mouse   Tab: hide this");
    ImGui::EndChild();
    ImGui::End();
  }
  if (desk.empty) draw_welcome(desk);
  draw_toasts(desk, now_s);
  if (desk.opening) draw_opening(desk);
  if (desk.help) draw_key_sheet(desk);
  if (desk.picker) draw_file_picker(desk);
  draw_state_strip(desk);  // last, over everything
}

}  // namespace palpa::viewer
