// Handles with which something is moved and turned: an arrow along each axis of the world, a square in each plane, a
// ring around each axis. Values and arithmetic only: where they are in a picture, which of them lies under the pointer,
// and what a drag of one does.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drawing/colour.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

/// The first three move along an axis, the next in the plane across it, the last turn around it.
enum class Handle { along_x, along_y, along_z, in_yz, in_zx, in_xy, around_x, around_y, around_z };
inline constexpr std::array all_handles{Handle::along_x,  Handle::along_y,  Handle::along_z,
                                        Handle::in_yz,    Handle::in_zx,    Handle::in_xy,
                                        Handle::around_x, Handle::around_y, Handle::around_z};

struct Gizmo {
  Vec3 at{};          ///< its middle, world
  double size_m = 0;  ///< length of its arrows
};
/// As large in every picture, however near it is.
Gizmo gizmo_at(const Vec3& at, const Sight& sight);

/// The handle within a few points of a pixel; the nearest to it.
std::optional<Handle> handle_at(const Gizmo& gizmo, const Sight& sight, double x, double y);

/// What a drag of the handle does to what it moves, as a rigid motion of the world: from one pixel to another. With
/// `snap` in steps of 1 mm, or of 5 degrees. Nothing where the handle is seen along its plane or its arrow.
std::optional<Transform> dragged(const Gizmo& gizmo, Handle handle, const Sight& sight, const Vec2& from,
                                 const Vec2& to, bool snap);

/// Something that lies flat on a picture, over everything in it.
struct FlatMark {
  std::vector<Vec2> points;            ///< pixels
  drawing::Colour colour{0, 0, 0, 0};  ///< of a label: nothing is that of other text
  double width = 1;                    ///< points
  bool filled = false;                 ///< a convex area, else a line
  std::string label{};                 ///< at the first point, in place of both
};
/// The handles, the one under the pointer told apart.
std::vector<FlatMark> gizmo_marks(const Gizmo& gizmo, const Sight& sight, std::optional<Handle> hovered);

}  // namespace palpa::viewer
