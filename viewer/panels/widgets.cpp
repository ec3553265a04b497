#include "viewer/panels/widgets.hpp"

#include <imgui_stdlib.h>

#include "viewer/panels/panels.hpp"

namespace palpa::viewer {
namespace {

/// Keeps what the user folds and unfolds. `draw` draws the heading and returns whether it is open.
bool folding(PanelData& data, const char* name, bool open, const std::function<bool()>& draw) {
  const auto known = data.headings.find(name);
  const bool was = known == data.headings.end() ? open : known->second;
  ImGui::SetNextItemOpen(was);
  const bool is = draw();
  data.places.named[name] = last_area();
  if (is != was) data.headings[name] = is;
  return is;
}

}  // namespace

float em(float lines) {
  return lines * ImGui::GetFontSize();
}

Area last_area() {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImDrawList& list = *ImGui::GetWindowDrawList();  // what is scrolled out of sight has no area
  const ImVec2 least = list.GetClipRectMin(), most = list.GetClipRectMax();
  return {std::max(low.x, least.x), std::max(low.y, least.y), std::min(high.x, most.x), std::min(high.y, most.y)};
}

void tip(const std::string& text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const ImVec2 whole = ImGui::GetIO().DisplaySize, low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  // The user who has just clicked it knows what it is, and wants to see what it does.
  const ImVec2 clicked = ImGui::GetIO().MouseClickedPos[0];
  if (clicked.x >= low.x && clicked.x < high.x && clicked.y >= low.y && clicked.y < high.y) return;
  const ImVec2 padding = ImGui::GetStyle().WindowPadding;
  const float gap = em(0.4f), top = static_cast<float>(strip_height(em(1))) + gap;
  const float panels = whole.x - static_cast<float>(panels_width(whole.x, em(1)));
  const bool in_panels = low.x >= panels && low.y >= top - gap;
  const float room = (in_panels ? panels : whole.x) - 2 * (gap + padding.x);
  const float wrap = std::clamp(room, 1.0f, em(24));
  const ImVec2 words = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const float height = words.y + 2 * padding.y;
  ImVec2 at{low.x, high.y + gap};
  if (in_panels) {
    at = {panels - gap - words.x - 2 * padding.x, low.y};
  } else if (at.y + height > whole.y) {
    at.y = low.y - gap - height;
  }
  at.x = std::clamp(at.x, 0.0f, std::max(whole.x - words.x - 2 * padding.x, 0.0f));
  at.y = std::max(std::min(at.y, whole.y - height), top);
  ImGui::SetNextWindowPos(at);
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(padding.x + wrap);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool heading(PanelData& data, const char* name, bool open, const char* about) {
  const bool shown = folding(data, name, open, [&] { return ImGui::CollapsingHeader(name); });
  tip(about);
  return shown;
}

bool subheading(PanelData& data, const char* name, const char* about, const std::string& shown) {
  const std::string label = (shown.empty() ? std::string(name) : shown) + "###" + name;
  const bool open = folding(data, name, false, [&] { return ImGui::TreeNode(label.c_str()); });
  tip(about);
  return open;
}

bool button(PanelData& data, const std::string& label, const std::string& about, bool enabled, const std::string& name,
            const ImVec2& size) {
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::Button(label.c_str(), size);
  data.places.named[name.empty() ? label : name] = last_area();
  ImGui::EndDisabled();
  tip(about);
  return pressed;
}

bool check_box(PanelData& data, const std::string& label, bool& value, const std::string& about,
               const std::string& name) {
  const bool changed = ImGui::Checkbox(label.c_str(), &value);
  data.places.named[name.empty() ? label : name] = last_area();
  tip(about);
  return changed;
}

bool slider(PanelData& data, const std::string& name, const char* label, int& value, int high, const char* format) {
  const int before = value;
  const bool changed = ImGui::SliderInt(label, &value, 0, high, format, ImGuiSliderFlags_NoInput);
  return after_drag(data, name, value, before, changed);
}

bool drag(PanelData& data, const char* label, double& value, double scale, float speed, float low, float high,
          const char* format) {
  const double before = value;
  auto shown = static_cast<float>(value * scale);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
  const bool changed = ImGui::DragFloat(label, &shown, speed, low, high, format,
                                        ImGuiSliderFlags_NoInput | ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = static_cast<double>(shown) / scale;
  return after_drag(data, label, value, before, changed);
}

bool text_field(PanelData& data, const std::string& name, const char* label, std::string& text,
                ImGuiInputTextFlags flags, const char* hint) {
  const bool entered = ImGui::InputTextWithHint(label, hint, &text, flags);
  if (ImGui::IsItemVisible()) data.places.texts.push_back(last_area());
  data.places.named[name] = last_area();
  return entered;
}

bool choice(PanelData& data, const std::string& name, const std::string& label, bool chosen,
            ImGuiSelectableFlags flags) {
  const bool pressed = ImGui::Selectable(label.c_str(), chosen, flags);
  data.places.named[name] = last_area();
  return pressed;
}

void drop_down(PanelData& data, const std::string& name, const char* label, const std::string& now,
               const std::function<void()>& choices, ImGuiComboFlags flags) {
  if (ImGui::BeginCombo(label, now.c_str(), flags)) {
    choices();
    ImGui::EndCombo();
  }
  data.places.named[name] = last_area();
}

std::optional<std::size_t> select_of(PanelData& data, const std::string& name, const std::vector<std::string>& lines,
                                     std::optional<std::size_t> now) {
  std::optional<std::size_t> chosen;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (choice(data, name + " " + lines[i], lines[i], now == i)) chosen = i;
    ImGui::PopID();
  }
  return chosen;
}

void name_closer(PanelData& data, const std::string& name) {
  const ImVec2 at = ImGui::GetWindowPos();
  const double right = at.x + ImGui::GetWindowWidth(), side = ImGui::GetFrameHeight();
  data.places.named[name] = {right - side, at.y, right, at.y + side};
}

Area free_area(const PanelData& data) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const double right = whole.x - (data.panels ? panels_width(whole.x, em(1)) : 0.0);
  return {0, strip_height(em(1)), right, whole.y};
}

}  // namespace palpa::viewer
