// The calibration target: a solid that a depth camera can recognise from every visible side, because a depth image
// shows no printed pattern. It is a plate with a truncated pyramid on it (the stump) whose four slopes all differ, so
// that no rotation maps it onto itself. It is printed in this position, in one piece, without supports.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::sensing {

/// Frame of the target: the origin in the middle of the plate's underside, z out of it, up the stump. The plate's
/// corner at +x +y is cut off. Metres.
struct TargetSize {
  static constexpr double plate_half = 0.065, plate_thickness = 0.006;
  static constexpr double base_half = 0.046;  ///< of the stump, at the plate
  static constexpr double height = 0.048;     ///< of the stump above the plate
  /// How far its sides lean inwards over that height, at +x, +y, -x, -y: 62, 44, 40 and 57 degrees steep.
  static constexpr std::array<double, 4> lean{0.0255, 0.0495, 0.057, 0.031};
  static constexpr double hole_radius = 0.0021;  ///< for M4 screws
  static constexpr double hole_least = 0.0495, hole_most = 0.0605;
};

/// Four holes through the plate, at (+-hole_x, +-hole_y). Screws in them fit between an array's transducers. No holes
/// if both are 0; otherwise each is within hole_least and hole_most of the middle.
struct TargetHoles {
  double x_m = 0, y_m = 0;
};

/// Welded, closed, oriented outwards.
geometry::Mesh make_target(const TargetHoles& holes = {});

/// The faces that are large enough to be recognised in a depth image: the plate's top, then the slopes as in
/// TargetSize.
std::vector<geometry::Plane> target_faces();

}  // namespace palpa::sensing
