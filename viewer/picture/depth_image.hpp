// A camera's depth as an image for people.
#pragma once

#include "sensing/depth_source.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

/// Replaces size and pixels of `image`: every so manieth pixel of the frame, so that none of the sides is longer than
/// 240. From light, the nearest, to dark, the farthest, but for the twentieth part of the pixels at either end; what is
/// no data is a shade that lets through what lies behind. Nothing where the frame is not the camera's.
void paint_depth(const sensing::Camera& camera, const sensing::DepthFrame& frame, ImageMark& image);

}  // namespace palpa::viewer
