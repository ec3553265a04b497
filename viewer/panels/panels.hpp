// The panels, drawn with Dear ImGui between Ui::begin() and Ui::end().
#pragma once

#include "viewer/panels/desk.hpp"

namespace palpa::viewer {

/// How much of a picture's width panels take, pixels; `line_height`: of a line of text, pixels.
double panels_width(double width, double line_height);

/// All that the desk says is open; `now_s` is the application's clock.
void draw_panels(Desk& desk, double now_s);

// Each is the content of one heading.
void draw_link_panel(Desk& desk);
void draw_view_panel(Desk& desk);
void draw_time_panel(Desk& desk);
void draw_place_panel(Desk& desk);
void draw_participant_panel(Desk& desk);
void draw_statistics_panel(const Desk& desk);
void draw_sound_panel(Desk& desk);
void draw_spectrum_panel(const Desk& desk);
void draw_options_panel(Desk& desk);
void draw_log_panel(const Desk& desk);

// Over everything.
void draw_marks(const std::vector<FlatMark>& marks);
void draw_toasts(Desk& desk, double now_s);
void draw_opening(Desk& desk);
void draw_cheat_sheet(Desk& desk);

/// Where the widget before it is.
Area last_area();
/// Explains the widget before it, while the pointer rests on it.
void tip(const char* text);

}  // namespace palpa::viewer
