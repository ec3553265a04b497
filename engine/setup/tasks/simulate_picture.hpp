// A simulated touch as two pictures, seen from below: where the foci are, and the pressure on the skin.
#pragma once

#include <string>

#include "drawing/png.hpp"
#include "setup/tasks/simulate_result.hpp"

namespace palpa::setup {

/// How deep the skin lies below y = `top_y`, crosses where the foci are, as the paper's Fig. 6 (1a) to (4a).
drawing::Pixels foci_picture(const SimulateResult& result, double top_y, const std::string& title);
/// The time-averaged radiation pressure beside its largest value, as (1b) to (4b).
drawing::Pixels pressure_picture(const SimulateResult& result, const std::string& title);

}  // namespace palpa::setup
