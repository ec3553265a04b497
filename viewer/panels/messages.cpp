// Messages: the log, lines that fade, and what is being loaded.
#include <imgui.h>

#include <algorithm>
#include <string>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

ImVec4 colour_of(log::Level level) {
  if (level == log::Level::error) return {0.84f, 0.15f, 0.10f, 1};
  if (level == log::Level::warning) return {0.93f, 0.56f, 0.0f, 1};
  return {0.22f, 0.46f, 0.75f, 1};
}

float width_in(const Area& free) {
  return std::max(std::min(em(24), static_cast<float>(free.right) - em(1)), 1.0f);
}

}  // namespace

void draw_log_panel(const PanelData& data) {
  ImGui::BeginChild("lines", {0, em(7)}, true);
  for (const log::Line& line : data.messages.log()) {
    ImGui::PushStyleColor(ImGuiCol_Text, line.level <= log::Level::warning ? colour_of(line.level)
                                                                           : ImGui::GetStyleColorVec4(ImGuiCol_Text));
    ImGui::TextWrapped("%s", line.text.c_str());
    ImGui::PopStyleColor();
  }
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
  ImGui::EndChild();
}

void draw_toasts(const PanelData& data) {
  const Area free = free_area(data);
  // The newest is the lowest. Legend, axes, scale and what is being loaded stay in sight.
  float y = static_cast<float>(free.bottom) - em(6.5f);
  int number = 0;
  for (auto toast = data.messages.toasts().rbegin(); toast != data.messages.toasts().rend(); ++toast) {
    ImGui::SetNextWindowPos({static_cast<float>(free.right) / 2, y}, ImGuiCond_Always, {0.5f, 1});
    ImGui::SetNextWindowSize({width_in(free), 0});
    ImGui::PushStyleColor(ImGuiCol_Border, colour_of(toast->level));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, em(0.12f));
    const std::string id = "toast" + std::to_string(number++);
    ImGui::Begin(id.c_str(), nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav);
    ImGui::TextWrapped("%s", toast->text.c_str());
    y -= ImGui::GetWindowHeight() + em(0.3f);
    ImGui::End();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
  }
}

void draw_opening(PanelData& data) {
  const Area free = free_area(data);
  ImGui::SetNextWindowPos({static_cast<float>(free.right) / 2, static_cast<float>(free.bottom) - em(1)},
                          ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSize({width_in(free), 0});
  ImGui::Begin("opening", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::TextWrapped("%s", data.content.doing.empty() ? "opening a file" : data.content.doing.c_str());
  if (data.content.done) {
    ImGui::ProgressBar(static_cast<float>(*data.content.done), {-em(5), 0});
    ImGui::SameLine();
  }
  if (button(data, "Cancel", "Cancels; what is shown and what runs stay as they are. Key: Escape", true, {}, {-1, 0}))
    data.asked.cancel = true;
  ImGui::End();
}

}  // namespace palpa::viewer
