// A camera's depth as an image for people to see.
#pragma once

#include "sensing/depth_source.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

/// Replaces size and pixels of `image` by every n-th pixel of the frame, so that no side is longer than 240. The shades
/// go from light (nearest) to dark (farthest), ignoring the nearest and the farthest twentieth of the pixels. Pixels
/// without data get a translucent shade. The image is empty if the frame is not the camera's.
void paint_depth(const sensing::Camera& camera, const sensing::DepthFrame& frame, ImageMark& image);

}  // namespace palpa::viewer
