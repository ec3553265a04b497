// Finds the pose of the calibration target in a camera's image, without an initial guess.
#pragma once

#include <cstdint>

#include "geometry/mesh/mesh_fit.hpp"
#include "sensing/camera.hpp"
#include "sensing/still_image.hpp"

namespace palpa::sensing {

struct FoundTarget {
  Transform T_camera_target{1.0};
  geometry::MeshFitted fit;  ///< of the target's points to its surface
  double agreement = 0;      ///< visible share of the target's surface that should be visible and is not hidden
  /// Observed size divided by the target's size. A target of another size and a scale error of the camera look alike.
  /// T_camera_target is the pose at scale 1.
  double scale = 1;
  double scale_deviation = 0;  ///< its standard deviation from the scatter alone; infinite if the view does not
                               ///< determine the scale
};

/// Whether that scale cannot be due to chance: it is off by at least 1.5 % and by many of its deviations.
bool scale_is_off(const FoundTarget& found);

/// Matches three flat patches with three of the target's faces, which all meet at different angles. Each match gives a
/// pose. The best pose explains most of the image and puts least of the target where the camera sees past it. It is
/// then fitted to all points (geometry/mesh/mesh_fit.hpp). Clutter does no harm as long as three faces are visible.
///
/// Throws bad_input, one line that names the camera: hardly any depth; no target; two poses that explain the image
/// equally well; a plate that goes on beyond the plate, because it is the board beneath it; a view that does not
/// determine the target in all six directions (MeshFitted::hold below least_hold).
FoundTarget find_target(const Camera& camera, const StillImage& image);

/// In simulated views of a board from low down (docs/notes/calibration-method.md), no pose with more was 0.1 mm off,
/// and one with 0.11 was 5 mm off.
inline constexpr double least_hold = 0.13;

}  // namespace palpa::sensing
