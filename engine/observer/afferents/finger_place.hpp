// Where a finger is over an object.
#pragma once

namespace palpa::observer {

/// The finger's place relative to the object's middle.
struct FingerPlace {
  double x_m = 0, z_m = 0;  ///< lateral
  double yaw_rad = 0;       ///< about the vertical axis
};

}  // namespace palpa::observer
