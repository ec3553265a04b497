// The sheet of a guided task, on the left of the picture.
#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <string>

#include "viewer/options/viewer_options.hpp"
#include "viewer/panels/file_font.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {

namespace {

/// Text of one of font_scales. A font of strokes has one size, and is magnified.
void write(std::size_t size, const std::string& text) {
  const ImVector<ImFont*>& fonts = ImGui::GetIO().Fonts->Fonts;
  const bool own = fonts.Size == static_cast<int>(font_scales.size());
  if (own) ImGui::PushFont(fonts[static_cast<int>(size)]);
  if (!own) ImGui::SetWindowFontScale(static_cast<float>(font_scales[size]));
  ImGui::TextWrapped("%s", text.c_str());
  if (!own) ImGui::SetWindowFontScale(1);
  if (own) ImGui::PopFont();
}

}  // namespace

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
  write(2, now.title);
  write(1, now.text);
  if (!now.fault.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4{0.79f, 0.30f, 0.0f, 1});
    write(1, now.fault);
    ImGui::PopStyleColor();
  }
  write(0, now.keys);
  ImGui::End();
}

}  // namespace palpa::viewer
