// What `palpa doctor` reports on video nodes: what they deliver, and problems that a lab would otherwise find too late,
// such as a coarse depth unit, a slow port, or cameras that share a USB controller.
#pragma once

#include <vector>

#include "cli/doctor.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

/// One item per node, by its number. Opens each for a moment and starts no stream.
std::vector<cli::DoctorItem> describe_nodes(Kernel& kernel);

}  // namespace palpa::driver::v4l2
