// The strip across the top: what the array does now, and the switches for it. Nothing covers it.
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "viewer/panel_data/array_status.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

const ImVec4 white{1, 1, 1, 1};

ImVec4 colour_of(ArrayState state) {
  switch (state) {
    case ArrayState::sounding:
    case ArrayState::unknown:
      return {0.79f, 0.30f, 0.0f, 1};
    case ArrayState::silent:
      return {0.06f, 0.40f, 0.36f, 1};
    case ArrayState::off:
      break;
  }
  return {0.33f, 0.35f, 0.38f, 1};
}

/// A square if it is off, a ring if it is silent, a disc with waves if it sounds or may sound.
void draw_sign(ImDrawList& list, ArrayState state, const ImVec2& centre, float radius) {
  const ImU32 ink = ImGui::ColorConvertFloat4ToU32(white);
  const float line = std::max(0.28f * radius, 1.0f);
  if (state == ArrayState::off) {
    list.AddRectFilled({centre.x - radius, centre.y - radius}, {centre.x + radius, centre.y + radius}, ink);
    return;
  }
  if (state == ArrayState::silent) {
    list.AddCircle(centre, radius, ink, 24, line);
    return;
  }
  list.AddCircleFilled({centre.x - 0.6f * radius, centre.y}, 0.5f * radius, ink, 16);
  for (const float wave : {1.1f, 1.7f}) {
    list.PathArcTo({centre.x - 0.6f * radius, centre.y}, wave * radius, -0.8f, 0.8f, 12);
    list.PathStroke(ink, 0, line);
  }
}

/// As much of the text as fits.
std::string cut_to(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  std::string part = text;
  while (!part.empty() && ImGui::CalcTextSize((part + "...").c_str()).x > width)
    part.pop_back();
  return part.empty() ? part : part + "...";
}

/// While the array is off, it looks like a button that is held down.
void draw_all_off(PanelData& data, bool off, const ImVec2& size) {
  ImGui::PushStyleColor(ImGuiCol_Button, off ? ImVec4{0.36f, 0.07f, 0.06f, 1} : ImVec4{0.80f, 0.10f, 0.09f, 1});
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, off ? ImVec4{0.36f, 0.07f, 0.06f, 1} : ImVec4{0.92f, 0.16f, 0.13f, 1});
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, ImVec4{0.30f, 0.05f, 0.05f, 1});
  ImGui::PushStyleColor(ImGuiCol_Border, off ? ImVec4{0, 0, 0, 0.9f} : ImVec4{1, 1, 1, 0.9f});
  ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, std::max(em(off ? 0.16f : 0.08f), 1.0f));
  if (button(data, "ALL OFF", "", true, {}, size)) data.asked.all_off = true;
  data.places.all_off = last_area();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(4);
  tip("Silence from the next slot on, and the end of the run. It stays off until you choose Start. Key: O");
}

void draw_start(PanelData& data, const ImVec2& size) {
  ImGui::BeginDisabled(!data.content.can_start);
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4{1, 1, 1, 0.20f});
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImVec4{1, 1, 1, 0.35f});
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, ImVec4{1, 1, 1, 0.5f});
  if (button(data, "Start", "", true, {}, size)) data.asked.start = true;
  data.places.start = last_area();
  ImGui::PopStyleColor(3);
  ImGui::EndDisabled();
  tip(data.content.live
          ? "Begins a run with the options under Run"
          : "Begins a live run of this object, with a fingertip that the pointer holds, or with the source under "
            "Run");
}

/// Only by dragging: nothing is typed, so keys stay keys. The array follows at once; the option is set when the slider
/// is released.
void draw_ceiling(PanelData& data, float width) {
  auto shown = static_cast<float>(data.ceiling.value_or(data.content.edit.options().safety.ceiling) * 100);
  ImGui::PushStyleColor(ImGuiCol_FrameBg, ImVec4{0, 0, 0, 0.25f});
  ImGui::PushStyleColor(ImGuiCol_FrameBgHovered, ImVec4{0, 0, 0, 0.35f});
  ImGui::PushStyleColor(ImGuiCol_FrameBgActive, ImVec4{0, 0, 0, 0.45f});
  ImGui::PushStyleColor(ImGuiCol_SliderGrab, ImVec4{1, 1, 1, 0.40f});
  ImGui::PushStyleColor(ImGuiCol_SliderGrabActive, ImVec4{1, 1, 1, 0.55f});
  ImGui::SetNextItemWidth(width);
  const ImGuiSliderFlags flags = ImGuiSliderFlags_NoInput | ImGuiSliderFlags_AlwaysClamp;
  if (ImGui::SliderFloat("##ceiling", &shown, 0, 100, "ceiling %.0f %%", flags))
    data.ceiling = std::clamp(std::round(static_cast<double>(shown)) / 100, 0.0, 1.0);
  data.places.ceiling = data.places.named["ceiling"] = last_area();
  if (!ImGui::IsItemActive() && data.ceiling) {
    const double ceiling = *std::exchange(data.ceiling, std::nullopt);
    data.asked.options.push_back(
        {"--ceiling", ceiling < 1 ? std::optional(fmt::format("{:g}", ceiling)) : std::nullopt});
  }
  ImGui::PopStyleColor(5);
  tip("The largest amplitude that a transducer may have. The pressure that skin feels follows its square, so 50 % "
      "leaves a quarter. The array follows at once, while you drag");
}

}  // namespace

double strip_height(double line_height) {
  return std::round(2.2 * line_height);
}

void draw_state_strip(PanelData& data) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const auto height = static_cast<float>(strip_height(em(1)));
  const ArrayStatus now = array_status(data.content);
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({whole.x, height});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour_of(now.state));
  ImGui::PushStyleColor(ImGuiCol_Text, white);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2{1, 1});
  ImGui::Begin("array", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  ImGui::PopStyleVar(3);
  const float gap = em(0.4f), button = height - 2 * em(0.25f);
  const float off_width = em(5), start_width = em(3.6f), ceiling_width = std::clamp(0.18f * whole.x, em(6.2f), em(9));
  const float right = std::max(whole.x - off_width - start_width - ceiling_width - 4 * gap, 0.0f);
  const float radius = 0.42f * em(1);
  const float left = em(0.6f) + 2 * radius + em(0.6f);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  draw_sign(list, now.state, {em(0.6f) + radius, height / 2}, radius);
  list.PushClipRect({0, 0}, {std::max(right - gap, 1.0f), height}, true);
  const ImU32 ink = ImGui::ColorConvertFloat4ToU32(white);
  const float line = (height - ImGui::GetFontSize()) / 2;
  for (const float bold : {0.0f, std::max(em(0.045f), 0.6f)})
    list.AddText({left + bold, line}, ink, now.word.c_str());
  const float after = left + ImGui::CalcTextSize(now.word.c_str()).x + em(0.8f);
  list.AddText({after, line}, ink, cut_to(now.more, right - gap - after).c_str());
  list.PopClipRect();

  ImGui::SetCursorPos({0, 0});
  if (right > gap) {
    ImGui::InvisibleButton("state", {right - gap, height});
    tip(now.state == ArrayState::sounding  ? "The array gets drives that sound: " + now.more
        : now.state == ArrayState::silent  ? "A run drives the link, and nothing sounds: " + now.more
        : now.state == ArrayState::unknown ? "The array may play its last sound on. Switch it off: " + now.more
                                           : "No drives leave: " + now.more);
  }
  ImGui::SetCursorPos({right, (height - ImGui::GetFrameHeight()) / 2});
  draw_ceiling(data, ceiling_width);
  ImGui::SetCursorPos({right + ceiling_width + gap, (height - button) / 2});
  draw_all_off(data, now.state == ArrayState::off, {off_width, button});
  ImGui::SetCursorPos({right + ceiling_width + off_width + 2 * gap, (height - button) / 2});
  draw_start(data, {start_width, button});
  ImGui::End();
  ImGui::PopStyleColor(2);
}

}  // namespace palpa::viewer
