// A window in which a file or a folder is chosen.
#include <imgui.h>

#include <algorithm>
#include <string>
#include <utility>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

void choose(PanelData& data) {
  const FilePicker picker = *std::exchange(data.picker, std::nullopt);
  const std::string file = chosen_file(picker);
  if (picker.option.empty()) {
    data.asked.open = file;
  } else if (picker.option == save_as) {
    data.moved_file = file;
  } else {
    data.asked.options.push_back({picker.option, picker.prefix + file});
  }
}

/// Buttons that go to folders where people look for files, and a list of the files that were opened before. Returns
/// whether one of these files was chosen.
bool draw_folders(PanelData& data, FilePicker& picker) {
  for (const NamedFolder& place :
       starting_folders(data.objects.empty() ? "" : folder_above(data.objects.front().path))) {
    if (button(data, place.name, place.folder)) picker.folder = place.folder;
    ImGui::SameLine();
  }
  bool chosen = false;
  if (picker.option.empty() && !data.content.recent.empty()) {
    ImGui::SetNextItemWidth(-1);
    drop_down(data, "opened before", "##recent", "opened before", [&] {
      for (const std::string& file : data.content.recent) {
        if (!choice(data, "opened before " + file, file, false)) continue;
        data.asked.open = file;
        chosen = true;
      }
    });
  } else {
    ImGui::NewLine();
  }
  return chosen;
}

/// Returns whether an entry was double-clicked that is to be chosen.
bool draw_entries(PanelData& data, FilePicker& picker, float height) {
  bool chosen = false;
  ImGui::BeginChild("files", {0, height}, true);
  if (!picker.fault.empty()) ImGui::TextWrapped("%s", picker.fault.c_str());
  std::string go_to;
  if (choice(data, "folder above", "..", false)) go_to = folder_above(picker.folder);
  for (const FilePicker::Entry& entry : picker.entries) {
    const std::string shown = entry.recording ? entry.name + "   (a recording)"
                              : entry.folder  ? entry.name + "/"
                                              : entry.name;
    if (!choice(data, "file " + entry.name, shown, picker.name == entry.name, ImGuiSelectableFlags_AllowDoubleClick))
      continue;
    const bool twice = ImGui::IsMouseDoubleClicked(0);
    // A file that is to be written may be put into the folder of a recording.
    const bool chosen_whole = entry.recording && !picker.is_new;
    if (entry.folder && !chosen_whole && (!picker.folders || twice)) {
      go_to = (picker.folder == "/" ? "" : picker.folder) + "/" + entry.name;
    } else {
      picker.name = entry.name;
      chosen = twice;
    }
  }
  ImGui::EndChild();
  if (!go_to.empty()) {
    picker.folder = std::move(go_to);
    if (!picker.is_new) picker.name.clear();
  }
  return chosen;
}

}  // namespace

void draw_file_picker(PanelData& data) {
  FilePicker& picker = *data.picker;
  list_files(picker);
  const Area free = free_area(data);
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const auto top = static_cast<float>(free.top);
  const ImVec2 size{std::min(em(30), whole.x - em(1)), std::min(em(22), whole.y - top - em(1))};
  ImGui::SetNextWindowPos({whole.x / 2, (whole.y + top) / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::max(size.x, 1.0f), std::max(size.y, 1.0f)});
  bool open = true;
  const std::string title = "Choose " + picker.title + "###picker";
  ImGui::Begin(title.c_str(), &open, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse);
  name_closer(data, "close the files");
  const bool opened = draw_folders(data, picker);
  ImGui::TextWrapped("%s", picker.folder.c_str());
  const float below = 2 * ImGui::GetFrameHeightWithSpacing();
  bool chosen = draw_entries(data, picker, std::max(ImGui::GetContentRegionAvail().y - below, em(2)));
  ImGui::SetNextItemWidth(-1);
  const char* const hint = picker.is_new ? "a new name" : "a name";
  if (text_field(data, "name", "##name", picker.name, ImGuiInputTextFlags_EnterReturnsTrue, hint)) chosen = true;
  const bool complete = !picker.name.empty() || picker.folders;
  chosen = button(data, "Choose", "", complete, "choose", {em(6), 0}) || chosen;
  ImGui::SameLine();
  if (button(data, "Cancel", "Nothing changes. Key: Escape", true, "cancel", {em(6), 0})) open = false;
  ImGui::End();
  if (chosen && is_folder_to_enter(picker)) {
    picker.folder = chosen_file(picker);
    picker.name.clear();
  } else if (chosen && (picker.folders || !picker.name.empty())) {
    choose(data);
  } else if (!open || opened) {
    data.picker.reset();
  }
}

}  // namespace palpa::viewer
