// What skin feels in time, for people and programs: --spectrum, and what --tune chose.
#pragma once

#include <span>
#include <string>

#include "acoustics/felt/spectrum.hpp"
#include "base/json_writer.hpp"
#include "session/plan/scheduler.hpp"

namespace palpa::cli {

/// The members "tune" and "spectrum" of a finger's object, each only where it was asked for.
void add_felt(JsonWriter& json, const session::ScheduledFinger& finger, const acoustics::Spectrum* spectrum);

/// The same as a few lines of text. `spectra`: one for each finger, or none.
std::string felt_lines(std::span<const session::ScheduledFinger> fingers, std::span<const acoustics::Spectrum> spectra);

}  // namespace palpa::cli
