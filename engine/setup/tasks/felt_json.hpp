// What skin feels in time, as JSON: --spectrum, and what --tune chose.
#pragma once

#include "acoustics/felt/spectrum.hpp"
#include "base/json_writer.hpp"
#include "session/plan/scheduler.hpp"

namespace palpa::setup {

/// The members "tune" and "spectrum" of a finger's object, each only where it was asked for; `spectrum` may be nullptr.
void add_felt(JsonWriter& json, const session::ScheduledFinger& finger, const acoustics::Spectrum* spectrum);

}  // namespace palpa::setup
