#include "viewer/panels/panels.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

/// What is done to everything, above the headings.
void draw_tools(PanelData& data) {
  if (button(data, "Open", "Opens a glTF model, a PLY or a recording. You can also drop it into the window", true,
             "open"))
    data.picker = picker_to_open(data.content.recent);
  ImGui::SameLine();
  const bool recording = !data.content.run.recording.empty();
  if (button(data, recording ? "Stop recording" : "Record",
             "Records what the cameras see into a new folder while the run continues, with any source. Key: R",
             data.content.live && data.content.run.state == LiveState::running, "record"))
    data.asked.record = true;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  drop_down(data, "copy", "##copy", "Copy", [&] {
    if (choice(data, "copy picture", "this picture, as palpa-viewer ...", false)) data.asked.copy_picture = true;
    if (choice(data, "copy run", "this run, as palpa run ...", false)) data.asked.copy = true;
  });
  tip("A command line that draws this picture, or that does this run without a window. Key: C, and Ctrl C for the run");
  if (recording) {
    ImGui::Text("%s: %s", data.content.run.recording.c_str(), counted(data.content.run.recorded, "frame").c_str());
    tip("The folder that is being written, and how many frames it has");
  }
  if (!recording && !data.content.made.empty() &&
      button(data, "Play " + data.content.made,
             "The run gets its frames from this recording. Space plays and pauses it, left and right step it", true,
             "play made"))
    data.asked.open = data.content.made;
  if (!data.content.doing.empty() && !data.content.opening) ImGui::TextWrapped("%s", data.content.doing.c_str());
}

void draw_headings(PanelData& data) {
  const bool touched = !data.picture->fingers.empty();
  if (heading(data, "Run", false, "What runs: the options of palpa run")) draw_options_panel(data);
  if (data.content.live &&
      heading(data, "Place", !data.placing->names().empty(), "How deep fingers are; solids and finger moved by hand"))
    draw_place_panel(data);
  if (heading(data, "Time", data.content.live || touched, "Slots of the schedule, frames of a recording"))
    draw_time_panel(data);
  if (heading(data, "View", !data.content.live, "What is drawn, and from where")) draw_view_panel(data);
  if (!data.participant.monitors.empty() &&
      heading(data, "Participant", false, "What the participant sees, in a window of its own"))
    draw_participant_panel(data);
  if (data.content.live && heading(data, "Statistics", true, "How long frames take, and how many there are"))
    draw_statistics_panel(data);
  const bool sounds = data.content.live || (!data.picture->transducers.empty() && touched);
  if (sounds && heading(data, "Sound", false, "The array's sound and its effect on the finger")) draw_sound_panel(data);
  data.wants_spectrum = sounds && heading(data, "Spectrum", false, "What skin feels in time");
  if (data.wants_spectrum) draw_spectrum_panel(data);
  if (heading(data, "Log", false, "Messages of palpa, newest last")) draw_log_panel(data);
}

}  // namespace

double panels_width(double width, double line_height) {
  return std::round(std::min(20.5 * line_height, 0.45 * width));
}

void draw_panels(PanelData& data) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  data.places = {};
  draw_marks(data.marks, free_area(data));
  data.wants_spectrum = data.wants_spectrum && data.panels;
  if (data.panels) {
    const auto width = static_cast<float>(panels_width(whole.x, em(1)));
    const auto top = static_cast<float>(strip_height(em(1)));
    ImGui::SetNextWindowPos({whole.x, top}, ImGuiCond_Always, {1, 0});
    ImGui::SetNextWindowSize({width, std::max(whole.y - top, 1.0f)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("palpa", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    draw_tools(data);
    ImGui::BeginChild("below");  // everything above stays in sight
    draw_headings(data);
    ImGui::TextDisabled("H: keys and mouse   Tab: hide this");
    ImGui::EndChild();
    ImGui::End();
  }
  if (data.content.empty) draw_welcome(data);
  draw_guidance(data);
  draw_toasts(data);
  if (data.content.opening) draw_opening(data);
  if (data.help) draw_key_sheet(data);
  if (data.picker) draw_file_picker(data);
  draw_state_strip(data);                            // last, over everything
  if (!ImGui::IsAnyItemActive()) data.drag.reset();  // of a widget that is not drawn any more
}

}  // namespace palpa::viewer
