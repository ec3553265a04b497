// The sheet of a guided task, on the left of the picture.
#include <imgui.h>

#include <algorithm>

#include "viewer/options/viewer_options.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {

void draw_guidance(PanelData& data) {
  if (!data.guidance) return;
  const Guidance& now = *data.guidance;
  const Area free = free_area(data);
  const auto share = static_cast<float>(guidance_share * free.right);
  const float width = std::max(share - 2 * em(0.5f), 1.0f);
  ImGui::SetNextWindowPos({em(0.5f), static_cast<float>(free.top) + em(0.5f)});
  ImGui::SetNextWindowSize({width, 0});
  ImGui::Begin("guidance", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav);
  ImGui::SetWindowFontScale(1.6f);
  ImGui::TextWrapped("%s", now.title.c_str());
  ImGui::SetWindowFontScale(1.2f);
  ImGui::TextWrapped("%s", now.text.c_str());
  if (!now.fault.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4{0.79f, 0.30f, 0.0f, 1});
    ImGui::TextWrapped("%s", now.fault.c_str());
    ImGui::PopStyleColor();
  }
  ImGui::SetWindowFontScale(1);
  ImGui::TextWrapped("%s", now.keys.c_str());
  ImGui::End();
}

}  // namespace palpa::viewer
