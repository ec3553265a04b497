#include "viewer/panels/key_sheet.hpp"

#include <imgui.h>

#include <algorithm>
#include <string_view>

#include "viewer/live/held_finger.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

enum class Need { nothing, scene, touch, slots, recording, live, running, finger, no_finger, plane, monitor };

bool holds_finger(const PanelData& data) {
  return data.content.live && HeldFinger::is_held(data.content.edit.options().source);
}

bool is_there(Need need, const PanelData& data) {
  switch (need) {
    case Need::nothing:
      return true;
    case Need::scene:
      return !data.content.edit.options().scene.empty();
    case Need::touch:
      return data.picture != nullptr && !data.picture->fingers.empty();
    case Need::slots:
      return data.picture != nullptr && (data.content.live || !data.picture->fingers.empty());
    case Need::recording:
      return data.content.run.playback.has_value();
    case Need::live:
      return data.content.live;
    case Need::running:
      return data.content.live && data.content.run.state == LiveState::running;
    case Need::finger:
      return holds_finger(data);
    case Need::no_finger:
      return !holds_finger(data);
    case Need::plane:
      return data.state.layers.shows(Layer::slice);
    case Need::monitor:
      return !data.participant.monitors.empty() && !data.content.edit.options().scene.empty();
  }
  return true;
}

const char* reason(Need need) {
  switch (need) {
    case Need::scene:
      return "there is no object yet: open one";
    case Need::touch:
      return "nothing touches";
    case Need::slots:
      return "there is no schedule, because nothing touches";
    case Need::recording:
      return "no recording is played: open one, or drop it into the window";
    case Need::live:
      return "this is one touch: Start begins a live run";
    case Need::running:
      return "no run is under way: Start begins one";
    case Need::finger:
      return "no finger is held by the pointer: that is the source mouse";
    case Need::monitor:
      return "there is no monitor or no object for a participant";
    case Need::nothing:
    case Need::no_finger:
    case Need::plane:
      break;
  }
  return "";
}

constexpr char arrows[] = {character_of(Key::left), character_of(Key::right), 0};
constexpr char pages[] = {character_of(Key::page_up), character_of(Key::page_down), 0};

struct Line {
  const char* keys;   ///< each of them; empty: the mouse, or a key with an effect in every mode
  const char* shown;  ///< on the sheet
  const char* meaning;
  Need need = Need::nothing;
};
constexpr Line lines[] = {
    {"", "left drag", "turn the view around the middle"},
    {"", "middle or Shift drag", "move the view sideways, up and down"},
    {"", "wheel", "nearer to what is under the pointer, or away", Need::no_finger},
    {"", "Ctrl wheel", "nearer to what is under the pointer, or away", Need::finger},
    {"", "wheel", "the finger moves into the picture, or out; Shift: finely", Need::finger},
    {"", "right drag", "the finger turns", Need::finger},
    {"", "Ctrl click", "read a point's place and depth", Need::scene},
    {"", "a plane's handles", "drag its middle along the arrow, an end to turn it", Need::plane},
    {"", "1 3 7 9", "front, right, top, corner; with Ctrl the other side"},
    {"", "5", "perspective or parallel"},
    {"", "F", "frame all"},
    {"t", "T", "frame the touch", Need::touch},
    {"m", "M", "the finger follows the pointer, or stays", Need::finger},
    {"g", "G", "handles to move and turn the next thing; Ctrl in steps", Need::live},
    {"z", "Ctrl Z", "undo the last move", Need::live},
    {arrows, "left right", "step the recording: one frame back, one on", Need::recording},
    {",.", ", .", "step the slots: one back, one on", Need::slots},
    {"-+=", "- +", "speed of the slots: slower, faster", Need::slots},
    {pages, "Page up, down", "another object: the next file of its folder", Need::scene},
    {"p", "P", "the participant's window: open, close", Need::monitor},
    {"v", "V", "the participant's object: hide, show", Need::monitor},
    {"r", "R", "record what the cameras see into a new folder; end that", Need::running},
    {"o", "O", "ALL OFF: the array is silent", Need::live},
    {"", "C, Ctrl C", "copy a command line of the picture; of the run", Need::scene},
    {"", "Tab", "hide the panels, show them"},
    {"", "H", "this sheet"},
    {"", "Escape", "close what is open"},
    {"", "Q", "quit; twice while the array sounds"},
};

}  // namespace

std::string idle_reason(const PanelData& data, Key key) {
  if (character_of(key) == 0) return {};
  for (const Line& line : lines) {
    if (std::string_view(line.keys).find(character_of(key)) != std::string_view::npos && !is_there(line.need, data))
      return std::string(line.shown) + ": " + reason(line.need);
  }
  return {};
}

std::vector<KeyLine> key_lines(const PanelData& data) {
  std::vector<KeyLine> out;
  out.push_back({"Space", data.content.run.playback ? "the recording: play, pause" : "the slots: play, pause"});
  for (const Line& line : lines) {
    if (is_there(line.need, data)) out.push_back({line.shown, line.meaning});
  }
  return out;
}

void draw_key_sheet(PanelData& data) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const auto top = static_cast<float>(free_area(data).top);
  const float height = std::max(whole.y - top - em(0.5f), 1.0f);
  ImGui::SetNextWindowPos({whole.x / 2, top + em(0.25f) + height / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({1, 1}, {std::max(whole.x - em(0.5f), 1.0f), height});
  ImGui::Begin("Keys and mouse", &data.help,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const KeyLine& line : key_lines(data)) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.keys.c_str());
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.meaning.c_str());
    }
    ImGui::EndTable();
  }
  ImGui::TextUnformatted("Drop a glTF model, a PLY or a recording into the window to open it.");
  ImGui::End();
}

}  // namespace palpa::viewer
