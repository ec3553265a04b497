// What skin feels over time, as JSON: --spectrum, and the values that --tune chose.
#pragma once

#include "acoustics/felt/spectrum.hpp"
#include "base/files/json_writer.hpp"
#include "session/plan/scheduler.hpp"

namespace palpa::setup {

/// Adds the members "tune" and "spectrum" to a finger's object, each only if it was requested; `spectrum` may be
/// nullptr.
void add_felt(JsonWriter& json, const session::ScheduledFinger& finger, const acoustics::Spectrum* spectrum);

}  // namespace palpa::setup
