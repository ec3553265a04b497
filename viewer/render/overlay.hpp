// What lies flat on the picture: foci with their numbers, legend, axes, scale. Built again for every frame as strokes
// in pixels, because it depends on the viewpoint.
#pragma once

#include <vector>

#include "shaders/viewer/view_scene.h"
#include "viewer/picture/picture.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

struct OverlayOptions {
  double width = 0, height = 0;  ///< of the view in pixels
  double ratio = 1;              ///< pixels per point, 2 on a high-resolution screen
  bool inset = false;            ///< a close-up inside another view: a border and a scale in place of legend and axes
};

/// Appends the overlay of `picture` with `state`, seen from `viewpoint`, in pixels from the view's top left. Later
/// strokes lie over earlier ones. Surfaces, points and transducers are only named and counted.
void build_overlay(const Picture& picture, const ViewState& state, const Viewpoint& viewpoint,
                   const OverlayOptions& options, std::vector<shader::ViewStroke>& strokes);

/// Length in metres of the scale bar: the longest of 1, 2 and 5 times a power of ten that is at most `longest_m`.
double scale_bar_length(double longest_m);

}  // namespace palpa::viewer
