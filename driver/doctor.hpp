// What the driver adds to `palpa doctor`: boards and depth cameras on this machine's USB, and who may open them.
#pragma once

#include <vector>

#include "cli/doctor.hpp"

namespace palpa::driver {

/// Sections "boards" and "cameras".
std::vector<cli::DoctorProbe> doctor_probes();

/// The depth cameras that the kernel knows.
cli::CamerasThere cameras_there();

}  // namespace palpa::driver
