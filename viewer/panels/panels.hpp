// The panels, drawn with Dear ImGui between Ui::begin() and Ui::end().
#pragma once

#include "viewer/panels/desk.hpp"

namespace palpa::viewer {

/// How much of a picture's width the panels take, in pixels. `line_height`: the height of a line of text, in pixels.
double panels_width(double width, double line_height);

/// Draws everything that is open according to the desk. `now_s` is the application's clock.
void draw_panels(Desk& desk, double now_s);

// Each draws the content of one heading.
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

// These are drawn over everything.
void draw_marks(const std::vector<FlatMark>& marks);
void draw_toasts(Desk& desk, double now_s);
void draw_opening(Desk& desk);
void draw_cheat_sheet(Desk& desk);

/// Where the last widget is.
Area last_area();
/// Explains the last widget while the pointer rests on it.
void tip(const char* text);

}  // namespace palpa::viewer
