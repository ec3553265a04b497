// What an empty window offers.
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {

namespace {

constexpr float panel_lines = 22, margin_lines = 1;  // lines of text

}  // namespace

double welcome_share(double free_width, double line) {
  const double needed = double{panel_lines + 2 * margin_lines} * line;
  return free_width >= 2 * needed ? needed / free_width : 0;
}

void draw_welcome(PanelData& data) {
  const Area free = free_area(data);
  const auto right = static_cast<float>(free.right), top = static_cast<float>(free.top);
  const auto bottom = static_cast<float>(free.bottom);
  const auto beside = static_cast<float>(welcome_share(free.right, em(1)));
  const float middle = beside > 0 ? right * (1 - beside / 2) : right / 2;
  ImGui::SetNextWindowPos({middle, (top + bottom) / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const float width = std::max(std::min(em(panel_lines), right - em(margin_lines)), 1.0f);
  ImGui::SetNextWindowSizeConstraints({width, 1}, {width, std::max(bottom - top - em(1), 1.0f)});
  ImGui::Begin("welcome", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  if (!data.objects.empty()) ImGui::TextWrapped("Touch an object:");
  const float half = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) / 2;
  for (std::size_t i = 0; i < data.objects.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine();
    const NamedFile& object = data.objects[i];
    if (button(data, object.name, object.path + ": the pointer holds a fingertip that touches it", true, {},
               {half, em(2.2f)}))
      data.asked.open = object.path;
  }
  ImGui::Spacing();
  if (button(data, "Open a file", "", true, "open a file", {-1, em(2.2f)}))
    data.picker = picker_to_open(data.content.recent);
  ImGui::TextWrapped("or drop a glTF model, a PLY or a recording here.");
  if (!data.content.recent.empty()) {
    ImGui::Spacing();
    ImGui::TextWrapped("Opened before:");
    for (const std::string& file : data.content.recent) {
      ImGui::PushID(file.c_str());
      const std::string name = std::filesystem::path(file).filename().string();
      if (choice(data, "recent " + file, name, false)) data.asked.open = file;
      tip(file);
      ImGui::PopID();
    }
  }
  ImGui::End();
}

}  // namespace palpa::viewer
