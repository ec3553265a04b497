// What the cameras of a rig would see, from simulated images (`palpa doctor --rig`): the contacts of a fingertip on the
// four objects of the paper's study, the calibration target on its mount, and the array's boards.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "setup/options/options.hpp"

namespace palpa::setup {

/// The objects, assets. A finger (assets/finger.ply, upright) presses 3 mm into the middle of the top of each.
inline constexpr std::array checked_objects{"cube", "semi-sphere", "pyramid", "prism"};

/// Shares of the skin in the shell of each object, by area, 0 to 1: what is in the image, in the camera's range,
/// hidden by nothing, and seen steeply enough for a depth.
using ContactShares = std::array<double, checked_objects.size()>;

struct CameraCheck {
  std::string name;
  ContactShares contacts{};
  double board_share = 0;      ///< of the image's pixels, with a depth on a board
  double hold = 0;             ///< of the target (geometry::MeshFitted); 0 if its pose is not found
  std::string target_fault{};  ///< why it is not found, one line
};

struct RigCheck {
  std::vector<CameraCheck> cameras;
  ContactShares contacts{};  ///< seen by at least one of the cameras
};

/// Renders what the cameras see, with the noise of a D415. Roi and mask of the cameras count, except for the target.
/// Throws as load_posed_rig does.
RigCheck check_rig(const RigOptions& options);

/// The least and the mean.
double least_of(const ContactShares& shares);
double mean_of(const ContactShares& shares);

}  // namespace palpa::setup
