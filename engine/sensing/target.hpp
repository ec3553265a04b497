// The calibration target: a solid that a depth camera can tell from every side that it sees, since a depth image shows
// no print. A plate, and on it a stump of a pyramid whose four slopes all differ, so that no turn maps it onto itself.
// It is printed as it lies, in one piece, without supports.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::sensing {

/// Frame of the target: the origin in the middle of the plate's underside, z out of it, up the stump. The corner of the
/// plate at +x +y is cut off. Metres.
struct TargetSize {
  static constexpr double plate_half = 0.065, plate_thickness = 0.006;
  static constexpr double base_half = 0.046;  ///< of the stump, where it leaves the plate
  static constexpr double height = 0.048;     ///< of the stump above the plate
  /// How far its sides lean inwards over that height, on the side of +x, +y, -x, -y: 62, 44, 40 and 57 degrees steep.
  static constexpr std::array<double, 4> lean{0.0255, 0.0495, 0.057, 0.031};
  static constexpr double hole_radius = 0.0021;  ///< for screws M4
  static constexpr double hole_least = 0.0495, hole_most = 0.0605;
};

/// Four holes through the plate, at (+-hole_x, +-hole_y); screws in them stand between an array's transducers. None
/// where both are 0; each within hole_least and hole_most of the middle.
struct TargetHoles {
  double x_m = 0, y_m = 0;
};

/// Welded, closed, oriented outwards.
geometry::Mesh make_target(const TargetHoles& holes = {});

/// Its faces that are large enough to be told in a depth image: the plate's top, then the slopes as in TargetSize.
std::vector<geometry::Plane> target_faces();

}  // namespace palpa::sensing
