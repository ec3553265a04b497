// The viewer's eye: an orbit around a target. Values and arithmetic only; window and pictures share it.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"
#include "base/words.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/view/frustum.hpp"

namespace palpa::viewer {

struct Viewpoint {
  Vec3 target{0, 0, 0};           ///< metres, world
  double azimuth = 0.6;           ///< radians around +y; 0 looks along -z from the front, pi/2 along -x from the right
  double elevation = 0.45;        ///< radians above the horizon, -pi/2..pi/2
  glm::dmat3 R_world_orbit{1.0};  ///< of the axes that azimuth and elevation turn around: the world's, or a camera's
  double distance = 0.3;          ///< metres from eye to target
  double fov = 0.44;              ///< vertical field of view, radians
  bool orthographic = false;      ///< parallel projection that shows the target as large as the perspective does
  /// Shares of the picture's width, and of its height, that something else covers. The target lies in the middle of the
  /// rest, undistorted (a shifted lens).
  double covered_left = 0, covered_right = 0, covered_below = 0;
  /// Replaces all of the above except the distance: the picture's scale bar is right at this distance. Anything that
  /// moves the viewpoint leaves the frustum, and the orbit goes on from there.
  std::optional<Frustum> frustum;
};

/// `camera` is what the first camera sees, and needs its pose.
enum class StandardView { front, right, top, iso, camera };
inline constexpr Word<StandardView> view_words[] = {{"front", StandardView::front},
                                                    {"right", StandardView::right},
                                                    {"top", StandardView::top},
                                                    {"iso", StandardView::iso},
                                                    {"camera", StandardView::camera}};

/// Turns the viewpoint to a standard view other than `camera`. Target, distance and projection stay.
void look(Viewpoint& viewpoint, StandardView view);
/// Puts the viewpoint into the frustum. The orbit has the same eye, and its target is as far in front of it as `about`.
void look(Viewpoint& viewpoint, const Frustum& frustum, const Vec3& about);
/// Puts the eye at `eye`, looking at `target`. The two must differ.
void look(Viewpoint& viewpoint, const Vec3& eye, const Vec3& target);
/// Moves target and distance so that `box` just fits an image of that width / height, with a margin. An empty box or a
/// point gives a view 10 cm wide.
void fit(Viewpoint& viewpoint, const Box& box, double aspect);

/// From now on, that share of the height is covered. The rest shows what the whole of it showed before: the eye moves
/// away from the target, unless it is `fixed`.
void cover_below(Viewpoint& viewpoint, double share, bool fixed);

/// Mouse: turns by a drag in pixels (a drag over `height` pixels is half a turn).
void orbit(Viewpoint& viewpoint, double dx, double dy, double height);
/// Moves the target so that what is at its depth follows the mouse.
void pan(Viewpoint& viewpoint, double dx, double dy, double height);
/// Positive steps come nearer.
void zoom(Viewpoint& viewpoint, double steps);

/// The viewpoint of a picture of that size.
struct Sight {
  Viewpoint viewpoint;
  double width = 0, height = 0;  ///< pixels
  double ratio = 1;              ///< pixels per point
};

struct Basis {
  Vec3 eye, right, up, forward;  ///< world; the last three are orthonormal
};
Basis basis(const Viewpoint& viewpoint);
/// Metres of the world per pixel at the target's depth, for an image of that height.
double metres_per_pixel(const Viewpoint& viewpoint, double height);

/// The projection part of the pipelines' push constants for an image of width x height pixels; `depth_bias`, colour and
/// style are left 0. Depth is reversed: 1 near, 0 far.
shader::ViewPush projection(const Viewpoint& viewpoint, double width, double height);

/// A half-line; the direction is a unit vector.
struct Ray {
  Vec3 from, direction;
};
/// The half-line through a pixel of such an image; the inverse of project().
Ray line_of_sight(const Viewpoint& viewpoint, double x, double y, double width, double height);
/// Where the ray meets the plane through `point`. nullopt if it does not, or if it is within 3 degrees of the plane's
/// direction.
std::optional<Vec3> meet(const Ray& ray, const Vec3& point, const Vec3& normal);

struct Projected {
  double x = 0, y = 0;   ///< pixels from the top left
  double depth = 0;      ///< metres in front of the eye
  bool visible = false;  ///< in front of the eye
};
Projected project(const shader::ViewPush& projection, const Vec3& world);

}  // namespace palpa::viewer
