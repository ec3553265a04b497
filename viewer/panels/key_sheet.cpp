#include "viewer/panels/key_sheet.hpp"

#include <imgui.h>

#include <algorithm>
#include <string_view>

#include "viewer/live/held_finger.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

bool holds_finger(const PanelData& data) {
  return data.content.live && HeldFinger::is_held(data.content.edit.options().source);
}

bool has_scene(const PanelData& data) {
  return !data.content.edit.options().scene.empty();
}

bool touches(const PanelData& data) {
  return data.picture != nullptr && !data.picture->fingers.empty();
}

/// When a key has an effect, and what the viewer says when it has none.
struct Need {
  bool (*is_there)(const PanelData& data);
  const char* reason = "";
};
constexpr Need needs_nothing{[](const PanelData&) { return true; }};
constexpr Need needs_scene{has_scene, "there is no object yet: open one"};
constexpr Need needs_touch{touches, "nothing touches"};
constexpr Need needs_slots{[](const PanelData& data) { return touches(data) || (data.picture && data.content.live); },
                           "there is no schedule, because nothing touches"};
constexpr Need needs_recording{[](const PanelData& data) { return data.content.run.playback.has_value(); },
                               "no recording is played: open one, or drop it into the window"};
constexpr Need needs_live{[](const PanelData& data) { return data.content.live; },
                          "this is one touch: Start begins a live run"};
constexpr Need needs_running{
    [](const PanelData& data) { return data.content.live && data.content.run.state == LiveState::running; },
    "no run is under way: Start begins one"};
constexpr Need needs_finger{holds_finger, "no finger is held by the pointer: that is the source mouse"};
constexpr Need needs_no_finger{[](const PanelData& data) { return !holds_finger(data); }};
constexpr Need needs_plane{[](const PanelData& data) { return data.state.layers.shows(Layer::slice); }};
constexpr Need needs_monitor{
    [](const PanelData& data) { return !data.participant.monitors.empty() && has_scene(data); },
    "there is no monitor or no object for a participant"};

constexpr char arrows[] = {character_of(Key::left), character_of(Key::right), 0};
constexpr char pages[] = {character_of(Key::page_up), character_of(Key::page_down), 0};

struct Line {
  const char* keys;   ///< each of them; empty: the mouse, or a key with an effect in every mode
  const char* shown;  ///< on the sheet
  const char* meaning;
  const Need& need = needs_nothing;
};
constexpr Line lines[] = {
    {"", "left drag", "turn the view around the middle"},
    {"", "middle or Shift drag", "move the view sideways, up and down"},
    {"", "wheel", "nearer to what is under the pointer, or away", needs_no_finger},
    {"", "Ctrl wheel", "nearer to what is under the pointer, or away", needs_finger},
    {"", "wheel", "the finger moves into the picture, or out; Shift: finely", needs_finger},
    {"", "right drag", "the finger turns", needs_finger},
    {"", "Ctrl click", "read a point's place and depth", needs_scene},
    {"", "a plane's handles", "drag its middle along the arrow, an end to turn it", needs_plane},
    {"", "1 3 7 9", "front, right, top, corner; with Ctrl the other side"},
    {"", "5", "perspective or parallel"},
    {"", "F", "frame all"},
    {"t", "T", "frame the touch", needs_touch},
    {"m", "M", "the finger follows the pointer, or stays", needs_finger},
    {"g", "G", "handles to move and turn the next thing; Ctrl in steps", needs_live},
    {"z", "Ctrl Z", "undo the last move", needs_live},
    {arrows, "left right", "step the recording: one frame back, one on", needs_recording},
    {",.", ", .", "step the slots: one back, one on", needs_slots},
    {"-+=", "- +", "speed of the slots: slower, faster", needs_slots},
    {pages, "Page up, down", "another object: the next file of its folder", needs_scene},
    {"p", "P", "the participant's window: open, close", needs_monitor},
    {"v", "V", "the participant's object: hide, show", needs_monitor},
    {"r", "R", "record what the cameras see into a new folder; end that", needs_running},
    {"o", "O", "ALL OFF: the array is silent", needs_live},
    {"", "C, Ctrl C", "copy a command line of the picture; of the run", needs_scene},
    {"", "Tab", "hide the panels, show them"},
    {"", "H", "this sheet"},
    {"", "Escape", "close what is open"},
    {"", "Q", "quit; twice while the array sounds"},
};

}  // namespace

std::string idle_reason(const PanelData& data, Key key) {
  if (character_of(key) == 0) return {};
  for (const Line& line : lines) {
    if (std::string_view(line.keys).find(character_of(key)) != std::string_view::npos && !line.need.is_there(data))
      return std::string(line.shown) + ": " + line.need.reason;
  }
  return {};
}

std::vector<KeyLine> key_lines(const PanelData& data) {
  std::vector<KeyLine> out;
  out.push_back({"Space", data.content.run.playback ? "the recording: play, pause" : "the slots: play, pause"});
  for (const Line& line : lines) {
    if (line.need.is_there(data)) out.push_back({line.shown, line.meaning});
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
  name_closer(data, "close the keys");
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
