// Handles that move and turn something: an arrow along each axis of the world, a square in each plane, a ring around
// each axis. Values and arithmetic only: where the handles are in a picture, which handle lies under the pointer, and
// what a drag of a handle does.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drawing/colour.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

/// The first three move along an axis, the next three in the plane across it, and the last three turn around it.
enum class Handle { along_x, along_y, along_z, in_yz, in_zx, in_xy, around_x, around_y, around_z };
inline constexpr std::array all_handles{Handle::along_x,  Handle::along_y,  Handle::along_z,
                                        Handle::in_yz,    Handle::in_zx,    Handle::in_xy,
                                        Handle::around_x, Handle::around_y, Handle::around_z};

struct Gizmo {
  Vec3 at{};          ///< its middle, world
  double size_m = 0;  ///< length of its arrows
};
/// The gizmo at `at`, with the same size in every picture at every distance.
Gizmo gizmo_at(const Vec3& at, const Sight& sight);

/// The nearest handle within a few points of a pixel.
std::optional<Handle> handle_at(const Gizmo& gizmo, const Sight& sight, double x, double y);

/// What a drag of the handle from one pixel to another does, as a rigid motion of the world. With `snap`, in steps of 1
/// mm or 5 degrees. nullopt if the line of sight runs along the handle's plane or arrow.
std::optional<Transform> dragged(const Gizmo& gizmo, Handle handle, const Sight& sight, const Vec2& from,
                                 const Vec2& to, bool snap);

/// Something that lies flat on a picture, over everything in it.
struct FlatMark {
  std::vector<Vec2> points;            ///< pixels
  drawing::Colour colour{0, 0, 0, 0};  ///< of a label: the default is the colour of other text
  double width = 1;                    ///< points
  bool filled = false;                 ///< a convex area, else a line
  std::string label{};                 ///< text at the first point, in place of area or line
};
/// The handles. The one under the pointer is highlighted.
std::vector<FlatMark> gizmo_marks(const Gizmo& gizmo, const Sight& sight, std::optional<Handle> hovered);

}  // namespace palpa::viewer
