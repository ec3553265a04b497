// What all panels are made of.
#pragma once

#include <imgui.h>

#include <functional>
#include <string>

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

/// A list that drops down, with `choices` drawn while it is open. `label` stands to its right; one that begins with ##
/// is not shown.
void drop_down(const char* label, const std::string& now, const std::function<void()>& choices);

/// The part of a picture that panels and strip leave free, in pixels.
Area free_area(const PanelData& data);

}  // namespace palpa::viewer
