// An eye and the window that it looks through: a camera's image, or a screen on which things appear where they are
// felt. Unlike a viewpoint's, its view may be off-centre.
#pragma once

#include "base/math.hpp"
#include "sensing/camera.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/view/vec4.hpp"

namespace palpa::viewer {

struct Frustum {
  Transform T_world_eye{1.0};    ///< x right, y up, z towards the viewer: it looks along -z
  Vec2 low{-1, -1}, high{1, 1};  ///< the window's left and bottom, its right and top edge, 1 m before the eye
  /// If true, the picture shows exactly the window, stretched if its shape is different. Otherwise, it shows more on
  /// two sides, so that its pixels are square.
  bool exact = false;
};

/// What the camera sees, without the distortion of its lens.
Frustum through(const sensing::Camera& camera);

/// What a picture of width / height `aspect` shows, in metres one metre before the eye.
Frustum shown(const Frustum& frustum, double aspect);

/// The projection part of the push constants, as for a viewpoint (viewpoint.hpp). Nothing nearer than `nearest_m` is
/// drawn.
shader::ViewPush projection(const Frustum& frustum, double width, double height, double nearest_m);

}  // namespace palpa::viewer
