// What all panels are made of. Each widget has a name under which scripts and tests find it, so panels use these
// functions and not Dear ImGui's own.
#pragma once

#include <imgui.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// The height of some lines of text, in pixels.
float em(float lines);

/// Where the last widget is, without the part that is scrolled out of sight.
Area last_area();
/// Explains the last widget while the pointer rests on it, unless the last click was there. The explanation stands
/// beside the panels, and covers neither them nor the strip at the top.
void tip(const std::string& text);

/// A heading that can be folded. Whether it is folded is kept in `data`, under its name. `open`: not folded at first.
bool heading(PanelData& data, const char* name, bool open, const char* about);
/// The same, one level below a heading. Call ImGui::TreePop() if it returns true.
/// `shown`: what the heading says, if this is not its name.
bool subheading(PanelData& data, const char* name, const char* about, const std::string& shown = {});

/// A button with its explanation. Returns whether it was pressed. `name`: for scripts and tests; empty: its label.
bool button(PanelData& data, const std::string& label, const std::string& about, bool enabled = true,
            const std::string& name = {}, const ImVec2& size = {0, 0});
/// The same for a box to tick.
bool check_box(PanelData& data, const std::string& label, bool& value, const std::string& about,
               const std::string& name = {});

/// What follows a drag of the widget that was drawn last: Escape during the drag gives the value back that was there
/// `before` it. `changed`: whether the widget has changed the value. Returns whether the value is another one now.
template <typename Number>
bool after_drag(PanelData& data, const std::string& name, Number& value, Number before, bool changed) {
  data.places.named[name] = last_area();
  if (ImGui::IsItemActivated()) data.drag = PanelData::Drag{name, static_cast<double>(before)};
  if (!data.drag || data.drag->name != name || ImGui::IsItemActive()) return changed;
  const PanelData::Drag drag = *std::exchange(data.drag, std::nullopt);
  if (!drag.cancelled) return changed;
  value = static_cast<Number>(drag.before);
  return true;
}
/// A number that is dragged and never typed, so that keys stay keys. `scale`: what is shown per unit of the value, and
/// `low` and `high` are in. Returns whether it was changed. `name`: for scripts and tests.
template <typename Number>
bool slider(PanelData& data, const std::string& name, const char* label, Number& value, double scale, float low,
            float high, const char* format, ImGuiSliderFlags more = 0) {
  const Number before = value;
  auto shown = static_cast<float>(value * scale);
  const bool changed = ImGui::SliderFloat(label, &shown, low, high, format, ImGuiSliderFlags_NoInput | more);
  if (changed) value = static_cast<Number>(std::clamp(shown, low, high) / scale);
  return after_drag(data, name, value, before, changed);
}
/// The same without a scale for a whole number from 0 to `high`.
bool slider(PanelData& data, const std::string& name, const char* label, int& value, int high, const char* format);
/// The same for a number with a wide range: a pixel of the drag is `speed` of what is shown.
bool drag(PanelData& data, const char* label, double& value, double scale, float speed, float low, float high,
          const char* format);

/// A line of text. Returns what ImGui::InputText returns. `name`: for scripts and tests.
bool text_field(PanelData& data, const std::string& name, const char* label, std::string& text,
                ImGuiInputTextFlags flags = 0, const char* hint = "");

/// One line of a list. Returns whether it was chosen. `name`: for scripts and tests.
bool choice(PanelData& data, const std::string& name, const std::string& label, bool chosen,
            ImGuiSelectableFlags flags = 0);
/// A list that drops down, with `choices` drawn while it is open. `label` stands to its right; one that begins with ##
/// is not shown.
void drop_down(PanelData& data, const std::string& name, const char* label, const std::string& now,
               const std::function<void()>& choices, ImGuiComboFlags flags = 0);
/// The same for the values of an enum, by their words, which are choices named "NAME WORD".
template <typename Enum, std::size_t count>
void drop_down(PanelData& data, const std::string& name, const char* label, const Word<Enum> (&words)[count],
               Enum& value) {
  drop_down(data, name, label, std::string(word_of(words, value)), [&] {
    for (const Word<Enum>& entry : words) {
      if (choice(data, name + " " + entry.word, entry.word, entry.value == value)) value = entry.value;
    }
  });
}
/// Lines of such a list, named "NAME LINE". Returns the one that was chosen.
std::optional<std::size_t> select_of(PanelData& data, const std::string& name, const std::vector<std::string>& lines,
                                     std::optional<std::size_t> now);

/// The button in the upper right corner of the current window, which closes it, is a widget of that name.
void name_closer(PanelData& data, const std::string& name);

/// The part of a picture that panels and strip leave free, in pixels.
Area free_area(const PanelData& data);

}  // namespace palpa::viewer
