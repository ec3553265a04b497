// Text about what skin feels over time: --spectrum, and the values that --tune chose.
#pragma once

#include <span>
#include <string>

#include "acoustics/felt/spectrum.hpp"
#include "session/plan/scheduler.hpp"

namespace palpa::cli {

/// A few lines of text about the requested results. `spectra`: one for each finger, or none.
std::string felt_lines(std::span<const session::ScheduledFinger> fingers, std::span<const acoustics::Spectrum> spectra);

}  // namespace palpa::cli
