// What all panels are made of.
#pragma once

#include <imgui.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
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
/// A number that is dragged and never typed, so that keys stay keys. `scale`: what is shown per unit of the value, and
/// `low` and `high` are in. Returns whether it was changed.
template <typename Number>
bool slider(const char* label, Number& value, double scale, float low, float high, const char* format,
            ImGuiSliderFlags more = 0) {
  auto shown = static_cast<float>(value * scale);
  if (!ImGui::SliderFloat(label, &shown, low, high, format, ImGuiSliderFlags_NoInput | more)) return false;
  value = static_cast<Number>(std::clamp(shown, low, high) / scale);
  return true;
}

/// A list that drops down, with `choices` drawn while it is open. `label` stands to its right; one that begins with ##
/// is not shown.
void drop_down(const char* label, const std::string& now, const std::function<void()>& choices);

/// The same for the values of an enum, by their words. `name`: before each of them, for scripts and tests.
template <typename Enum, std::size_t count>
void drop_down(PanelData& data, const char* label, const Word<Enum> (&words)[count], Enum& value, const char* name) {
  drop_down(label, std::string(word_of(words, value)), [&] {
    for (const Word<Enum>& entry : words) {
      if (ImGui::Selectable(entry.word, entry.value == value)) value = entry.value;
      data.places.named[std::string(name) + " " + entry.word] = last_area();
    }
  });
}
/// Lines of such a list. Returns the one that was chosen.
std::optional<std::size_t> select_of(const std::vector<std::string>& names, std::optional<std::size_t> now);

/// The part of a picture that panels and strip leave free, in pixels.
Area free_area(const PanelData& data);

}  // namespace palpa::viewer
