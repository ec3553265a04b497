// The panels, drawn with Dear ImGui between Ui::begin() and Ui::end().
#pragma once

#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

// The places of the panels: the strip with the array's state is across the top, the others are on the right below it.
// In pixels; `line_height` is the height of a line of text.
double strip_height(double line_height);
double panels_width(double width, double line_height);

/// Draws everything that is open according to `data`.
void draw_panels(PanelData& data);

void draw_state_strip(PanelData& data);

// Each of these functions draws the content of one heading.
void draw_view_panel(PanelData& data);
void draw_time_panel(PanelData& data);
void draw_place_panel(PanelData& data);
void draw_participant_panel(PanelData& data);
void draw_statistics_panel(PanelData& data);
void draw_sound_panel(PanelData& data);
void draw_spectrum_panel(const PanelData& data);
void draw_options_panel(PanelData& data);
void draw_log_panel(const PanelData& data);

// These are drawn over the picture.
/// `free`: the part of the window in which labels must stay.
void draw_marks(const std::vector<FlatMark>& marks, const Area& free);
void draw_guidance(PanelData& data);
void draw_toasts(const PanelData& data);
void draw_opening(PanelData& data);
/// The share of the free area's width, from the right, that it covers; 0 if it covers the middle because there is no
/// room beside it. `line`: the height of a line of text, pixels.
double welcome_share(double free_width, double line);
void draw_welcome(PanelData& data);
void draw_key_sheet(PanelData& data);
void draw_file_picker(PanelData& data);

}  // namespace palpa::viewer
