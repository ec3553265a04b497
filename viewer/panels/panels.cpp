#include "viewer/panels/panels.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace palpa::viewer {
namespace {

/// Points to pixels, by the size of the text.
float em(float lines) {
  return lines * ImGui::GetFontSize();
}

ImVec4 colour_of(log::Level level) {
  if (level == log::Level::error) return {0.84f, 0.15f, 0.10f, 1};
  if (level == log::Level::warning) return {0.93f, 0.56f, 0.0f, 1};
  return {0.22f, 0.46f, 0.75f, 1};
}

bool heading(const char* name, bool open, const char* about) {
  const bool shown = ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  tip(about);
  return shown;
}

}  // namespace

Area last_area() {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImDrawList& list = *ImGui::GetWindowDrawList();  // what is scrolled out of sight has no area
  const ImVec2 least = list.GetClipRectMin(), most = list.GetClipRectMax();
  return {std::max(low.x, least.x), std::max(low.y, least.y), std::min(high.x, most.x), std::min(high.y, most.y)};
}

void tip(const char* text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(em(24));
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

double panels_width(double width, double line_height) {
  return std::round(std::min(19 * line_height, 0.45 * width));
}

void draw_panels(Desk& desk, double now_s) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  desk.places = {};
  draw_marks(desk.marks);
  if (desk.panels) {
    const auto width = static_cast<float>(panels_width(whole.x, em(1)));
    ImGui::SetNextWindowPos({whole.x, 0}, ImGuiCond_Always, {1, 0});
    ImGui::SetNextWindowSize({width, whole.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("palpa", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    if (desk.live) {
      draw_link_panel(desk);
    }
    ImGui::BeginChild("below");  // everything above stays in sight
    if (desk.live) {
      if (heading("Run", false, "What runs: the options of palpa run")) draw_options_panel(desk);
    }
    if (desk.live &&
        heading("Place", !desk.placed.things.empty(), "How deep fingers are; solids and finger moved by hand"))
      draw_place_panel(desk);
    if (heading("Time", desk.live || !desk.picture->fingers.empty(), "Slots of the schedule, frames of a recording"))
      draw_time_panel(desk);
    if (heading("View", !desk.live, "What is drawn, and from where")) draw_view_panel(desk);
    if (!desk.participant.monitors.empty() &&
        heading("Participant", false, "What the participant sees, in a window of its own"))
      draw_participant_panel(desk);
    if (desk.live && heading("Statistics", true, "How long frames take, and how many there are"))
      draw_statistics_panel(desk);
    const bool sounds = desk.live || (!desk.picture->transducers.empty() && !desk.picture->fingers.empty());
    if (sounds && heading("Sound", false, "The array's sound and its effect on the finger")) draw_sound_panel(desk);
    desk.wants_spectrum = sounds && heading("Spectrum", false, "What skin feels in time");
    if (desk.wants_spectrum) draw_spectrum_panel(desk);
    if (heading("Log", false, "Messages of palpa, newest last")) draw_log_panel(desk);
    ImGui::TextDisabled("H: keys and mouse   Tab: hide this");
    ImGui::EndChild();
    ImGui::End();
  }
  if (desk.reading) {
    ImGui::SetNextWindowPos({em(0.5f), whole.y - em(0.5f)}, ImGuiCond_Always, {0, 1});
    ImGui::Begin("reading", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    const Reading& r = *desk.reading;
    ImGui::Text("%s  %.2f  %.2f  %.2f mm", r.what.c_str(), r.at.x * 1e3, r.at.y * 1e3, r.at.z * 1e3);
    if (r.depth_m) ImGui::Text("%.2f mm deep", *r.depth_m * 1e3);
    ImGui::End();
  }
  draw_toasts(desk, now_s);
  if (desk.opening) draw_opening(desk);
  if (desk.help) draw_cheat_sheet(desk);
}

void draw_link_panel(Desk& desk) {
  const bool running = desk.live_state == LiveState::running;
  ImGui::PushStyleColor(ImGuiCol_Button, {0.76f, 0.12f, 0.10f, 1});
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, {0.88f, 0.18f, 0.14f, 1});
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, {0.60f, 0.08f, 0.08f, 1});
  ImGui::PushStyleColor(ImGuiCol_Text, {1, 1, 1, 1});
  if (ImGui::Button("ALL OFF", {ImGui::GetContentRegionAvail().x * 0.6f, em(2)})) desk.asked.all_off = true;
  desk.places.all_off = last_area();
  ImGui::PopStyleColor(4);
  tip("Silence from the next slot on, and the end of the run. Key: O");
  ImGui::SameLine();
  ImGui::BeginDisabled(running || desk.live_state == LiveState::loading);
  if (ImGui::Button("Start", {-1, em(2)})) desk.asked.start = true;
  ImGui::EndDisabled();
  tip("Runs again with the options below");
  const char* state = desk.live_state == LiveState::loading  ? "loading"
                      : desk.live_state == LiveState::failed ? "failed"
                      : desk.live_state == LiveState::ended  ? "off"
                      : desk.sounding                        ? "SOUNDING"
                                                             : "silent";
  ImGui::Text("link %s", desk.edit.options().link.c_str());
  ImGui::SameLine();
  const ImVec4 lamp = desk.sounding ? ImVec4{0.80f, 0.36f, 0, 1} : ImVec4{0.35f, 0.35f, 0.38f, 1};
  ImGui::TextColored(lamp, "%s", state);
  tip("What the array does now, by the drives that leave for it");
  ImGui::BeginDisabled(!running);
  if (ImGui::SmallButton(desk.recording.empty() ? "record" : "stop recording")) desk.asked.record = true;
  ImGui::EndDisabled();
  tip("Records what the cameras see into a new folder while the run continues, with any source. Key: R");
  if (!desk.recording.empty()) {
    ImGui::SameLine();
    ImGui::Text("%s: %llu", desk.recording.c_str(), static_cast<unsigned long long>(desk.recorded));
    tip("The folder, and how many frames it has");
  }
  if (!desk.doing.empty() && !desk.opening) ImGui::TextWrapped("%s", desk.doing.c_str());
}

void draw_view_panel(Desk& desk) {
  for (const auto& [name, view] : {std::pair("front", StandardView::front), std::pair("right", StandardView::right),
                                   std::pair("top", StandardView::top), std::pair("iso", StandardView::iso)}) {
    if (ImGui::SmallButton(name)) desk.asked.view = view;
    tip("Keys: 1 front, 3 right, 7 top, 9 iso; with Ctrl from the other side");
    ImGui::SameLine();
  }
  if (ImGui::SmallButton("frame")) desk.asked.frame = true;
  tip("Fits everything into the picture. Key: F");
  ImGui::Checkbox("parallel", &desk.state.viewpoint.orthographic);
  tip("Parallel projection in place of perspective. Key: 5");
  ImGui::SameLine();
  ImGui::Checkbox("dark", &desk.state.dark);
  tip("Dark background");
  ImGui::SetNextItemWidth(em(7));
  if (ImGui::BeginCombo("fine pictures", std::string(word_of(fine_words, desk.state.fine)).c_str())) {
    for (const Word<FinePictures>& entry : fine_words) {
      if (ImGui::Selectable(entry.word, entry.value == desk.state.fine)) desk.state.fine = entry.value;
    }
    ImGui::EndCombo();
  }
  tip("Four samples for each pixel. auto: if drawing is slow, one sample while the picture moves, and four when it "
      "rests");
  auto explode = static_cast<float>(desk.state.explode);
  ImGui::SetNextItemWidth(em(7));
  if (ImGui::SliderFloat("explode", &explode, 0, 1, "%.2f")) desk.state.explode = std::clamp(explode, 0.0f, 1.0f);
  tip("How far convex parts are drawn apart");
  if (ImGui::BeginTable("layers", 2, ImGuiTableFlags_SizingStretchSame)) {
    for (const Word<Layer>& entry : layer_words) {
      LayerState& layer = desk.state.layers[entry.value];
      ImGui::TableNextColumn();
      ImGui::PushID(entry.word);
      ImGui::Checkbox(entry.word, &layer.visible);
      tip("Whether it is drawn");
      ImGui::TableNextColumn();
      ImGui::SetNextItemWidth(-1);
      float percent = layer.opacity * 100;
      if (ImGui::SliderFloat("##opacity", &percent, 0, 100, "%.0f %%"))
        layer.opacity = std::clamp(percent / 100, 0.0f, 1.0f);
      tip("How firmly it is drawn");
      ImGui::PopID();
    }
    ImGui::EndTable();
  }
}

void draw_log_panel(const Desk& desk) {
  ImGui::BeginChild("lines", {0, em(7)}, true);
  for (const log::Line& line : desk.log) {
    ImGui::PushStyleColor(ImGuiCol_Text, line.level <= log::Level::warning ? colour_of(line.level)
                                                                           : ImGui::GetStyleColorVec4(ImGuiCol_Text));
    ImGui::TextWrapped("%s", line.text.c_str());
    ImGui::PopStyleColor();
  }
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
  ImGui::EndChild();
}

void draw_toasts(Desk& desk, double now_s) {
  std::erase_if(desk.toasts, [&](const Toast& toast) { return now_s >= toast.until_s; });
  const float whole = ImGui::GetIO().DisplaySize.x;
  const float free = whole - (desk.panels ? static_cast<float>(panels_width(whole, em(1))) : 0.0f);
  float y = em(0.5f);
  int number = 0;
  for (const Toast& toast : desk.toasts) {
    ImGui::SetNextWindowPos({free / 2, y}, ImGuiCond_Always, {0.5f, 0});
    ImGui::SetNextWindowSize({std::max(std::min(em(24), free - em(1)), 1.0f), 0});
    ImGui::PushStyleColor(ImGuiCol_Border, colour_of(toast.level));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, em(0.12f));
    const std::string id = "toast" + std::to_string(number++);
    ImGui::Begin(id.c_str(), nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav);
    ImGui::TextWrapped("%s", toast.text.c_str());
    y += ImGui::GetWindowHeight() + em(0.3f);
    ImGui::End();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
  }
}

void draw_opening(Desk& desk) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const float free = whole.x - (desk.panels ? static_cast<float>(panels_width(whole.x, em(1))) : 0.0f);
  ImGui::SetNextWindowPos({free / 2, whole.y - em(1)}, ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSize({std::max(std::min(em(24), free - em(1)), 1.0f), 0});
  ImGui::Begin("opening", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::TextWrapped("%s", desk.doing.empty() ? "opening a file" : desk.doing.c_str());
  if (desk.done) {
    ImGui::ProgressBar(static_cast<float>(*desk.done), {-em(5), 0});
    ImGui::SameLine();
  }
  if (ImGui::Button("cancel", {-1, 0})) desk.asked.cancel = true;
  tip("Cancels; what is shown and what runs stay as they are. Key: Escape");
  ImGui::End();
}

void draw_cheat_sheet(Desk& desk) {
  static constexpr std::pair<const char*, const char*> lines[] = {
      {"left drag", "turn around the middle"},
      {"middle or Shift drag", "move along"},
      {"wheel", "nearer to what is under the pointer"},
      {"Ctrl click", "read a point's place and depth"},
      {"a plane's handles", "drag its middle along the arrow, an end to turn it"},
      {"1 3 7 9", "front, right, top, corner; with Ctrl the other side"},
      {"5", "perspective or parallel"},
      {"F", "frame everything"},
      {"M", "source mouse: the finger follows the pointer, or stays"},
      {"wheel, right drag", "it goes deeper into the picture (Shift: finely); turns"},
      {"G", "handles to move and turn: the next thing's; Ctrl in steps"},
      {"Ctrl Z", "takes the last move back"},
      {"Space", "stop and go on: slots, or the recording"},
      {", .", "one slot back, one on"},
      {"left right", "one frame of the recording back, one on"},
      {"- +", "slots slower, faster"},
      {"Page up, down", "another object: the scenes of the folder"},
      {"P, V", "the participant's window; the object in it hidden"},
      {"R", "record what the cameras see, into a new folder"},
      {"O", "all off: the array is silent"},
      {"C", "copy the run as a command line"},
      {"Tab", "panels"},
      {"H", "this sheet"},
      {"Escape, Q", "close what is open; quit"},
  };
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({whole.x / 2, whole.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("Keys and mouse", &desk.help,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
  if (ImGui::BeginTable("keys", 2)) {
    for (const auto& [key, meaning] : lines) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(key);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(meaning);
    }
    ImGui::EndTable();
  }
  ImGui::TextDisabled("Drop a .glb or .gltf, or the folder of a recording, into the window to open it.");
  ImGui::End();
}

}  // namespace palpa::viewer
