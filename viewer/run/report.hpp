// The reports at the end: on the pictures, and on a run that was shown.
#pragma once

#include "base/files/outputs.hpp"
#include "drawing/png.hpp"
#include "session/watch/stats.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// The pictures that were drawn.
struct PicturesDrawn {
  session::Samples ms;  ///< time of each: updating, drawing and, in a window, presenting it
  Size size;            ///< of the last
};

/// Writes the last picture, compares it, and reports on it.
void report_picture(const ViewerOptions& options, const Outputs& outputs, const drawing::Pixels& pixels,
                    const PicturesDrawn& drawn);

/// Reports on the pictures of a window, if a number of them was asked for.
void report_window(const ViewerOptions& options, const Outputs& outputs, const PicturesDrawn& drawn);

/// Reports on a run as `palpa run` does; nothing if there was no run, or if it failed.
void report_run(const ViewerOptions& options, const Outputs& outputs, const LiveSession* session);

}  // namespace palpa::viewer
