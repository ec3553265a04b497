// Where the calibration target stands before a camera, without a guess.
#pragma once

#include <cstdint>

#include "geometry/mesh/mesh_fit.hpp"
#include "sensing/camera.hpp"
#include "sensing/still_image.hpp"

namespace palpa::sensing {

struct FoundTarget {
  Transform T_camera_target{1.0};
  geometry::MeshFitted fit;  ///< of its points to the target's surface
  double agreement = 0;      ///< of the surface that should be seen, and is not hidden, the share that is
  /// How much larger than the target what is seen is: the target itself, or the camera's measure of it; the two look
  /// alike. T_camera_target is the pose at scale 1.
  double scale = 1;
  double scale_deviation = 0;  ///< its standard deviation from the scatter alone; infinite: the view does not say
};

/// Whether that scale cannot be chance: it is off by 1.5 % at least, and by many of its deviations.
bool scale_is_off(const FoundTarget& found);

/// Three flat patches are matched with three of the target's faces, which all meet at other angles; a match is a pose,
/// and the pose that explains most of what is seen, and puts least of the target where the camera sees past it, is
/// fitted to all points (geometry/mesh/mesh_fit.hpp). Clutter does no harm as long as three faces are seen beside it.
///
/// Throws bad_input, one line that names the camera: hardly any depth; no target; two poses that explain the image
/// equally well; a view that does not hold the target in all six directions (MeshFitted::hold below least_hold).
FoundTarget find_target(const Camera& camera, const StillImage& image);

/// Below that a face that is 0.1 mm off moves the pose by more than a millimetre.
inline constexpr double least_hold = 0.1;

}  // namespace palpa::sensing
