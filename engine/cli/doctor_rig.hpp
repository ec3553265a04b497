// `palpa doctor --write-rig`: a rig file for the available cameras, to be calibrated; and `palpa doctor --rig`: what
// the cameras of a rig would see.
#pragma once

#include <string>

#include "cli/command.hpp"
#include "cli/doctor.hpp"
#include "setup/options/options.hpp"

namespace palpa::cli {

/// The cameras of `source`, which is a recording or a bag; if `source` is empty, the cameras that are plugged in.
/// Throws failure() if there are none, bad_usage for a source that does not describe its cameras.
CamerasThere cameras_there(const Extensions& extensions, const std::string& source);

/// The rig as TOML, with comments on what is known about each camera and on how to find the poses. `file`: the name
/// under which it will be written. `like`: a rig whose array it gets, and whose poses, camera by camera; empty: none.
/// Throws bad_input if that rig has another number of cameras, or no array.
std::string rig_of(const CamerasThere& there, const std::string& file, const std::string& like);

/// Section "rig": an item for each camera, and one for all of them together. Throws as setup::check_rig does.
DoctorSection look_at_rig(const setup::RigOptions& options);

}  // namespace palpa::cli
