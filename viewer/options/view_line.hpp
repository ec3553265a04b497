// A picture as a command line that draws it again.
#pragma once

#include <string>

#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// What is seen, besides what `options` say.
struct SeenView {
  ViewState state;
  Size size;                            ///< of the picture, without panels
  double ratio = 1;                     ///< pixels per point
  bool placed = false;                  ///< the plane of the field was given a place
  std::uint64_t frames = 0;             ///< of a live run, so far
  std::optional<setup::Plane> plane{};  ///< of the field, before it was turned by hand
};

/// The line of `palpa-viewer` that draws the picture into a file, without a window. `run`: for a live run, its options;
/// they replace those of `options`.
std::string picture_command(const ViewerOptions& options, const line::Given& run, const SeenView& seen);

}  // namespace palpa::viewer
