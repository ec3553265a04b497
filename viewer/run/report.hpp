// What is told at the end: of pictures, and of a run that was looked at.
#pragma once

#include <cstdint>
#include <optional>

#include "base/outputs.hpp"
#include "drawing/png.hpp"
#include "session/watch/stats.hpp"
#include "viewer/app/viewer_options.hpp"

namespace palpa::viewer {

/// The pictures that were drawn.
struct PicturesDrawn {
  session::Samples ms;  ///< that each took: updating, drawing and, of a window, presenting it
  Size size;            ///< of the last
};

/// The last picture: writes it down, compares it, tells of it.
void report_picture(const ViewerOptions& options, const Outputs& outputs, const drawing::Pixels& pixels,
                    const PicturesDrawn& drawn);

/// Those of a window: told where somebody has asked for so many of them.
void report_window(const ViewerOptions& options, const Outputs& outputs, const PicturesDrawn& drawn);

/// As `palpa run` does; nothing of what was none.
void report_run(const ViewerOptions& options, const Outputs& outputs, const std::optional<session::LoopStats>& stats);

}  // namespace palpa::viewer
