// `palpa doctor --write-rig`: a rig file for the cameras that are there, to be calibrated.
#pragma once

#include <string>

#include "cli/command.hpp"
#include "cli/doctor.hpp"

namespace palpa::cli {

/// The cameras of `source`, a recording or a bag; of none those that are plugged in. Throws failure() where there are
/// none, bad_usage for a source that does not say itself what its cameras are.
CamerasThere cameras_there(const Extensions& extensions, const std::string& source);

/// The rig as TOML, with a comment on what is known of each camera and on how their poses are found. `file`: under
/// which name it will be written.
std::string rig_of(const CamerasThere& there, const std::string& file);

}  // namespace palpa::cli
