// The panels, drawn with Dear ImGui between Ui::begin() and Ui::end().
#pragma once

#include "viewer/desk/desk.hpp"

namespace palpa::viewer {

// The places of the panels: the strip with the array's state is across the top, the others are on the right below it.
// In pixels; `line_height` is the height of a line of text.
double strip_height(double line_height);
double panels_width(double width, double line_height);

/// Draws everything that is open according to the desk. `now_s` is the application's clock.
void draw_panels(Desk& desk, double now_s);

void draw_state_strip(Desk& desk);

// Each of these functions draws the content of one heading.
void draw_view_panel(Desk& desk);
void draw_time_panel(Desk& desk);
void draw_place_panel(Desk& desk);
void draw_participant_panel(Desk& desk);
void draw_statistics_panel(Desk& desk);
void draw_sound_panel(Desk& desk);
void draw_spectrum_panel(const Desk& desk);
void draw_options_panel(Desk& desk);
void draw_log_panel(const Desk& desk);

// These are drawn over the picture.
/// `free`: the part of the window in which labels must stay.
void draw_marks(const std::vector<FlatMark>& marks, const Area& free);
void draw_toasts(Desk& desk, double now_s);
void draw_opening(Desk& desk);
void draw_welcome(Desk& desk);
void draw_key_sheet(Desk& desk);
void draw_file_picker(Desk& desk);

}  // namespace palpa::viewer
