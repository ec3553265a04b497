// The two ways to look at a show: pictures without a window, and a window.
#pragma once

#include "viewer/show.hpp"
#include "viewer/viewer_options.hpp"

namespace palpa::viewer {

/// Draws --frames pictures, a slot each; writes all of them or the last, and compares that. Throws failure() where it
/// differs from the reference by more than the threshold.
void run_headless(const ViewerOptions& options);

/// Opens a window and shows until it is closed or --frames have been drawn. The running focus moves on in slow motion,
/// a slot every quarter of a second; with --frames, with every frame.
void run_window(const ViewerOptions& options);

}  // namespace palpa::viewer
