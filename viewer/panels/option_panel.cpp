// The options of the run. A value that is not the default has a mark, and a button that resets it.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viewer/live/live_line.hpp"
#include "viewer/panel_data/option_words.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

/// The text, beginning with a capital. Words such as glTF stay.
std::string sentence(std::string text) {
  const bool plain = text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) && !text.starts_with("gl");
  if (plain) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// One option while its row is drawn.
struct Row {
  PanelData& data;
  const line::OptionInfo& info;
  const OptionWords words;
  const std::optional<std::string> value;  ///< nullopt: the default
  float width = 0;                         ///< of its field

  std::string default_text() const { return shown_default(info); }
  /// What the option is, what it is set to, and what it would be by default.
  std::string explained() const {
    std::string text = sentence(words.about);
    if (const std::string meaning = meaning_of(info.name, now()); !meaning.empty())
      text += fmt::format("\n{}: {}", now(), meaning);
    return text + fmt::format("\nDefault: {}. In a command line: {}", info.flag ? "off" : default_text(), info.name);
  }
  std::string now() const { return value.value_or(default_text()); }
  void set(const std::optional<std::string>& text) const { data.asked.options.push_back({info.name, text}); }
  /// A text that is the default is not stored as the user's.
  void type(const std::string& text) const {
    const std::string typed = with_unit(text, words);
    if (typed == now() || text == now()) return;
    set(text.empty() || typed == default_text() ? std::nullopt : std::optional(typed));
  }
  void choose_file(const std::string& title, std::vector<std::string> endings, const std::string& prefix = {}) const {
    FilePicker picker{.title = title, .option = info.name, .prefix = prefix, .endings = std::move(endings)};
    const std::string last = value.value_or("").substr(value && value->starts_with(prefix) ? prefix.size() : 0);
    picker.folder = last.find('/') != std::string::npos ? folder_above(last) : ".";
    picker.folders = words.kind == FieldKind::folder || (words.kind == FieldKind::source && picker.endings.empty());
    picker.is_new =
        words.kind == FieldKind::new_file || words.kind == FieldKind::new_folder || words.kind == FieldKind::link;
    data.picker = picker;
  }
};

/// A line of the option's list.
bool choice_of(const Row& row, const std::string& line, bool chosen = false) {
  return choice(row.data, row.info.name + " " + line, line, chosen);
}

void offer(const Row& row, const std::string& name, const std::string& value) {
  if (choice_of(row, name, row.value == value)) row.set(value);
}

/// Each word once; the default has a note.
void draw_words(const Row& row) {
  const bool among = std::ranges::find(row.info.words, row.info.initial) != row.info.words.end();
  ImGui::SetNextItemWidth(row.width);
  drop_down(row.data, row.info.name, "##value", row.now(), [&] {
    if (!among && choice_of(row, row.default_text() + "  (default)", !row.value)) row.set(std::nullopt);
    for (const std::string& word : row.info.words) {
      const bool is_default = word == row.info.initial;
      const bool chosen = choice_of(row, is_default ? word + "  (default)" : word, word == row.now());
      if (const std::string meaning = meaning_of(row.info.name, word); !meaning.empty()) tip(sentence(meaning));
      if (chosen) row.set(is_default ? std::nullopt : std::optional(word));
    }
  });
}

void draw_text(const Row& row, float width) {
  std::string text = row.now();
  ImGui::SetNextItemWidth(width);
  text_field(row.data, row.info.name, "##value", text, ImGuiInputTextFlags_AutoSelectAll);
  // Typed text is not used until it is finished.
  if (ImGui::IsItemDeactivatedAfterEdit()) row.type(text);
}

void draw_choices(const Row& row) {
  const PanelData& data = row.data;
  if (choice_of(row, row.default_text() + "  (default)", !row.value)) row.set(std::nullopt);
  switch (row.words.kind) {
    case FieldKind::object:
      for (const NamedFile& object : data.objects)
        offer(row, object.name, object.path);
      if (choice_of(row, "choose a file ...")) row.choose_file("a glTF model", {".glb", ".gltf"});
      break;
    case FieldKind::rig:
      for (const NamedFile& rig : data.rigs)
        offer(row, rig.name, rig.path);
      if (choice_of(row, "choose a file ...")) row.choose_file("a rig", {".toml"});
      break;
    case FieldKind::layout:
      for (const std::string& layout : data.layouts)
        offer(row, layout, layout);
      if (choice_of(row, "choose a file ...")) row.choose_file("a layout", {".toml"});
      break;
    case FieldKind::source:
      offer(row, "mouse: the pointer holds a fingertip", "mouse");
      offer(row, "synthetic: a fingertip that dips by itself", "synthetic");
      if (choice_of(row, "recording: choose a folder ...")) row.choose_file("a recording", {}, "recording:");
      if (choice_of(row, "bag: choose a file ..."))
        row.choose_file("a file of RealSense Viewer", {".db3", ".bag"}, "bag:");
      tip("A recording of RealSense Viewer");
      offer(row, "joints: hands from a tracker's program", "joints:udp:9000");
      tip("Lines of JSON that the program sends to UDP port 9000 of this computer");
      break;
    case FieldKind::link:
      if (choice_of(row, "record: choose a file ...")) row.choose_file("a file for the drives", {}, "record:");
      tip("Every drive is written into a file");
      offer(row, "foci:udp: to a program on this computer", "foci:udp:127.0.0.1:9000");
      tip("A line of JSON with the foci for each frame, to UDP port 9000");
      break;
    case FieldKind::plain:
    case FieldKind::folder:
    case FieldKind::new_file:
    case FieldKind::new_folder:
      break;
  }
}

/// A field to type into, with a button to its right: a list, or a file picker.
void draw_field(const Row& row) {
  const FieldKind kind = row.words.kind;
  if (kind == FieldKind::plain) return draw_text(row, row.width);
  const float side = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemInnerSpacing.x;
  draw_text(row, std::max(row.width - side - gap, 1.0f));
  tip(row.explained());
  ImGui::SameLine(0, gap);
  const bool picks = kind == FieldKind::folder || kind == FieldKind::new_file || kind == FieldKind::new_folder;
  if (picks) {
    if (button(row.data, "...", "Chooses a file or folder", true, row.info.name + " file", {side, 0}))
      row.choose_file(kind == FieldKind::new_file ? "a file to be written" : "a folder", {});
    return;
  }
  drop_down(
      row.data, row.info.name + " list", "##list", "", [&] { draw_choices(row); },
      ImGuiComboFlags_NoPreview | ImGuiComboFlags_PopupAlignLeft);
}

void draw_label(const Row& row) {
  ImGui::AlignTextToFramePadding();
  const float mark = em(0.35f);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (row.value) {
    ImGui::GetWindowDrawList()->AddCircleFilled({at.x + mark / 2, at.y + ImGui::GetFrameHeight() / 2}, mark / 2,
                                                ImGui::GetColorU32(ImGuiCol_CheckMark), 12);
  }
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + em(0.55f));
  ImGui::TextUnformatted(label_of(row.words).c_str());
  tip(row.explained());
}

void draw_option(PanelData& data, const line::OptionInfo& info) {
  Row row{data, info, words_of(info), data.content.edit.text(info.name)};
  ImGui::PushID(info.name.c_str());
  ImGui::TableNextColumn();
  draw_label(row);
  ImGui::TableNextColumn();
  // Only a changed option has a button that resets it. Its field is shorter.
  const float side = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemInnerSpacing.x;
  const float whole = ImGui::GetContentRegionAvail().x, right = ImGui::GetCursorPosX() + whole;
  row.width = std::max(row.value ? whole - side - gap : whole, 1.0f);
  if (info.flag) {
    bool on = row.value.has_value();
    if (check_box(data, "##value", on, "", info.name)) row.set(on ? std::optional(std::string()) : std::nullopt);
  } else if (!info.words.empty()) {
    draw_words(row);
  } else {
    draw_field(row);
  }
  tip(row.explained());
  if (row.value) {
    ImGui::SameLine();
    ImGui::SetCursorPosX(right - side);
    if (button(data, "\u00d7", "Back to the default: " + (info.flag ? "off" : row.default_text()), true,
               info.name + " reset", {side, 0}))
      row.set(std::nullopt);
  }
  ImGui::PopID();
}

/// Two columns: names, and values with their resets.
void draw_options(PanelData& data, std::span<const line::OptionInfo> options) {
  ImGui::Unindent();  // names need the room
  const bool open = ImGui::BeginTable("options", 2);
  if (!open) return ImGui::Indent();
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.1f);
  for (const line::OptionInfo& info : options)
    draw_option(data, info);
  ImGui::EndTable();
  ImGui::Indent();
}

/// How many of them the user has set, for the heading.
std::string heading_of(const PanelData& data, std::span<const line::OptionInfo> options) {
  const auto set =
      std::ranges::count_if(options, [&](const auto& info) { return data.content.edit.text(info.name).has_value(); });
  return set == 0 ? options.front().heading : fmt::format("{} ({} changed)", options.front().heading, set);
}

}  // namespace

void draw_options_panel(PanelData& data) {
  if (!data.content.live && !data.content.empty) {
    ImGui::TextWrapped("Options of the touch take effect at once, the others when Start begins a run.");
  }
  const std::vector<line::OptionInfo>& table = live_table();
  for (auto first = table.begin(); first != table.end();) {
    const auto last =
        std::find_if(first, table.end(), [&](const auto& info) { return info.heading != first->heading; });
    const std::span<const line::OptionInfo> options(first, last);
    if (subheading(data, first->heading.c_str(), "", heading_of(data, options))) {
      draw_options(data, options);
      ImGui::TreePop();
    }
    first = last;
  }
  const bool open = subheading(data, "Only in the copied command",
                               "How long palpa run runs and what it prints in a terminal: the viewer runs until it is "
                               "closed, and has panels");
  if (!open) return;
  draw_options(data, copied_table());
  ImGui::TreePop();
}

}  // namespace palpa::viewer
