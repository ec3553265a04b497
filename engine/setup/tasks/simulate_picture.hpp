// A simulated touch as two pictures, seen from below: the foci, and the pressure on the skin.
#pragma once

#include <string>

#include "drawing/png.hpp"
#include "setup/tasks/simulate_result.hpp"

namespace palpa::setup {

/// The depth of the skin below y = `top_y`, with crosses at the foci, as in the paper's Fig. 6 (1a) to (4a).
drawing::Pixels foci_picture(const SimulateResult& result, double top_y, const std::string& title);
/// The time-averaged radiation pressure relative to its largest value, as in (1b) to (4b).
drawing::Pixels pressure_picture(const SimulateResult& result, const std::string& title);

}  // namespace palpa::setup
